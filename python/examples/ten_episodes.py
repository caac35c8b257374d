"""Ten episodes with a co-pilot: a simulated pilot asks, MISC decides what is carried out."""

import cohelm
import gymnasium

env = gymnasium.make("cohelm/SharedControl-v1", rule="misc").unwrapped
pilot = cohelm.SimulatedPilot(env.world)  # a model of a person; any agent of yours can sit here
for seed in range(10):
    env.reset(seed=seed)
    pilot.reset(seed)
    tick = {"ending": None}
    while tick["ending"] is None:
        asked = pilot.ask(env.world)
        *_, tick = env.step(env.nothing if asked is None else asked)
    print(f"episode {seed}: {tick['ending']}")
