#!/usr/bin/env python3
"""Record LunarLander-v3 flights of many kinds with Gymnasium: the format of record_gymnasium.py, harder situations.

    pip install "gymnasium[box2d]==1.4.0"          # embeds Box2D 2.3.0
    python record_varied.py OUT.jsonl.gz FIRST_SEED SEEDS [KIND...]

For each seed and each kind of pilot one episode, both action spaces by turns. Lines have three more fields: `gravity`,
`wind_power`, `turbulence_power`, drawn for each episode (half of the episodes have the usual ones).

    sticky      a random action held for a random time
    drop        nothing at all
    rest        Gymnasium's controller until a leg touches, then nothing: the craft settles and sleeps
    slope       the same, but aiming beside the pad: legs on slopes, tilting, sliding
    hop         the same, but with pushes of the engines on the ground: contacts begin and end
    hover       keeps its height: time limit
    spin        one side engine, mostly
    slam        falls fast, brakes late, hits hard: impacts within steps
    noisy       Gymnasium's controller with random actions in between
"""
import gzip, json, sys
import numpy as np
import gymnasium as gym
from gymnasium.envs.box2d.lunar_lander import heuristic

KINDS = "sticky drop rest slope hop hover spin slam noisy".split()
IDLE, LEFT, MAIN, RIGHT = range(4)
THROTTLES = {IDLE: (0.0, 0.0), LEFT: (0.0, -1.0), MAIN: (1.0, 0.0), RIGHT: (0.0, 1.0)}


class Pilot:
    def __init__(self, kind, lander, draw):
        self.kind, self.lander, self.draw = kind, lander, draw
        self.offset = draw.uniform(-0.7, 0.7)
        self.held, self.left = IDLE, 0
        self.touched = 0

    def random(self):
        if self.lander.continuous:
            return self.draw.uniform(-1.2, 1.2, 2)
        return int(self.draw.integers(4))

    def plain(self, index):
        return np.array(THROTTLES[index]) if self.lander.continuous else index

    def steer(self, obs, offset=0.0, height=0.0):
        shifted = np.array(obs, np.float64)
        shifted[0] -= offset
        shifted[1] -= height
        return heuristic(self.lander, shifted)

    def act(self, obs):
        draw, kind = self.draw, self.kind
        self.touched += bool(obs[6] or obs[7])
        if kind == "sticky":
            if self.left <= 0:
                self.held, self.left = self.random(), draw.integers(1, 40)
            self.left -= 1
            return self.held
        if kind == "drop":
            return self.plain(IDLE)
        if kind == "rest":
            return self.plain(IDLE) if self.touched else self.steer(obs)
        if kind == "slope":
            return self.plain(IDLE) if self.touched > 5 else self.steer(obs, self.offset)
        if kind == "hop":
            if self.touched and draw.random() < 0.3:
                return self.plain(int(draw.choice([LEFT, MAIN, RIGHT])))
            return self.plain(IDLE) if self.touched and draw.random() < 0.7 else self.steer(obs, self.offset * 0.4)
        if kind == "hover":
            return self.steer([*obs[:6], 0, 0], 0.0, 0.4)
        if kind == "spin":
            return self.plain(RIGHT) if draw.random() < 0.2 else self.plain(MAIN if draw.random() < 0.3 else IDLE)
        if kind == "slam":
            late = obs[1] < 0.25 + 0.1 * draw.random() and obs[3] < -0.5
            tilt = obs[4] * 0.5 + obs[5]
            return self.plain(MAIN if late else LEFT if tilt < -0.1 else RIGHT if tilt > 0.1 else IDLE)
        return self.random() if draw.random() < 0.4 else self.steer(obs)


def fly(kind, seed):
    draw = np.random.default_rng([seed, KINDS.index(kind)])
    odd = bool(draw.integers(2))
    options = dict(continuous=bool(draw.integers(2)), enable_wind=bool(draw.integers(2)),
                   gravity=round(draw.uniform(-11.9, -2), 3) if odd else -10.0,
                   wind_power=round(draw.uniform(0, 20), 3) if odd else 15.0,
                   turbulence_power=round(draw.uniform(0, 2), 3) if odd else 1.5)
    env = gym.make("LunarLander-v3", **options)
    obs, _ = env.reset(seed=seed)
    lander = env.unwrapped
    ground = [float(p1[1]) for p1, *_ in lander.sky_polys] + [float(lander.sky_polys[-1][1][1])]
    pilot = Pilot(kind, lander, draw)
    actions, seen, rewards = [], [obs], []
    while True:
        action = pilot.act(obs)
        action = np.asarray(action, np.float32) if lander.continuous else int(action)
        obs, reward, terminated, truncated, _ = env.step(action)
        actions.append([float(x) for x in action] if lander.continuous else action)
        seen.append(obs)
        rewards.append(float(reward))
        if terminated or truncated:
            break
    return dict(seed=seed, continuous=options["continuous"], wind=options["enable_wind"], gravity=options["gravity"],
                wind_power=options["wind_power"], turbulence_power=options["turbulence_power"], pilot=kind, terrain=ground,
                actions=actions, observations=[[float(x) for x in o] for o in seen], rewards=rewards,
                terminated=bool(terminated), truncated=bool(truncated))


if __name__ == "__main__":
    out, first, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    episodes = steps = 0
    with gzip.GzipFile(out, "wb", mtime=0) as file:
        for seed in range(first, first + count):
            for kind in sys.argv[4:] or KINDS:
                flight = fly(kind, seed)
                file.write((json.dumps(flight, separators=(",", ":")) + "\n").encode())
                episodes, steps = episodes + 1, steps + len(flight["actions"])
    print(f"{out}: {episodes} episodes, {steps} steps")
