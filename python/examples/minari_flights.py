"""Flights of a simulated pilot with a co-pilot as a Minari data set, read again by Minari's own loader."""

import sys

import cohelm
import gymnasium
import minari
from cohelm.offline import write_minari

name, episodes = sys.argv[1:] or ("cohelm/misc-v0", "10")
env = gymnasium.make("cohelm/SharedControl-v1", rule="misc")
world = env.unwrapped.world
pilot = cohelm.SimulatedPilot(world)


def choose(observation, info):
    if world.ticks == 0:
        pilot.reset(info["seed"])
    asked = pilot.ask(world)
    return env.unwrapped.nothing if asked is None else asked


write_minari(env, choose, name, episodes=int(episodes), algorithm_name="simulated pilot, MISC", author="cohelm")
data = minari.load_dataset(name)
for episode in data.iterate_episodes():
    print(f"episode {episode.id}: {len(episode.rewards)} steps, return {episode.rewards.sum():.2f}")
