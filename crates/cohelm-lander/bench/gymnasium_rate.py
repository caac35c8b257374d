#!/usr/bin/env python3
"""Steps a second of Gymnasium's LunarLander-v3 on one core, random actions, resets included.

    pip install "gymnasium[box2d]==1.4.0"
    python gymnasium_rate.py [STEPS]

Prints one JSON object: `steps`, `episodes`, `seconds` (wall clock) and `steps_per_s`. Actions are drawn beforehand, and the
environment checker is off: what is timed is the environment. `cohelm bench lander` runs this between runs of its own.
"""
import json, sys, time
import numpy as np
import gymnasium as gym

steps = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
env = gym.make("LunarLander-v3", disable_env_checker=True)
actions = np.random.default_rng(1).integers(4, size=steps).tolist()
env.reset(seed=0)
episodes = 0
start = time.perf_counter()
for action in actions:
    _, _, terminated, truncated, _ = env.step(action)
    if terminated or truncated:
        env.reset()
        episodes += 1
seconds = time.perf_counter() - start
print(json.dumps(dict(steps=steps, episodes=episodes, seconds=seconds, steps_per_s=steps / seconds)))
