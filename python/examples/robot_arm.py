"""Only the arbitration: an arm of two joints, a critic of one's own, and a person who aims a little wrong.

At every tick some joint speeds are sampled, the critic says what each is worth for the inferred goal, and the rule
decides.
"""

import numpy as np
from cohelm import Rule

CUPS = np.array([[0.9, 0.8], [-0.6, 1.1]])  # m, where the hand may want to go
LENGTHS = np.array([0.8, 0.7])  # m
TICK_S = 0.05


def hand(joints):
    """Where the hand is, m, for joint angles of shape (..., 2), rad."""
    angles = np.cumsum(joints, axis=-1)
    return np.stack([(LENGTHS * np.cos(angles)).sum(-1), (LENGTHS * np.sin(angles)).sum(-1)], axis=-1)


def critic(joints, speeds, goal):
    """What joint speeds are worth: how much nearer to the goal they bring the hand, m."""
    distance = lambda angles: np.linalg.norm(hand(angles) - goal, axis=-1)  # noqa: E731
    return distance(joints) - distance(joints + TICK_S * speeds)


def reach(rule, seed, ticks=120):
    """How far from the first cup the hand of a person ends, m, who misjudges angles by about half a radian."""
    draws = np.random.default_rng(seed)
    joints, wrong = np.array([0.2, 0.4]), draws.normal(0.0, 0.5, size=2)
    for _ in range(ticks):
        near = np.linalg.norm(CUPS - hand(joints), axis=1)
        goal, confidence = CUPS[near.argmin()], float(np.ptp(near) / near.sum())
        candidates = draws.uniform(-1.0, 1.0, size=(64, 2))
        meant = candidates[critic(joints + wrong, candidates, CUPS[0]).argmax()]
        decided = rule.decide_among(critic(joints, candidates, goal), candidates, confidence, asked=meant)
        joints = joints + TICK_S * decided
    return float(np.linalg.norm(hand(joints) - CUPS[0]))


if __name__ == "__main__":
    for name in ("hic", "lasc", "misc"):
        distances = [reach(Rule(name), seed) for seed in range(20)]
        print(f"{name:5} ends {100 * np.mean(distances):5.1f} cm from the cup, mean of {len(distances)} people")
