#!/usr/bin/env python3
"""More recordings of the format of record_statistics.py: other shapes, heavy ties, zero differences, degenerate tables.

    pip install pingouin==0.7.0 scipy==1.17.1
    python record_other_shapes.py OUT.json SEED CASES KIND

KIND is `shapes` (8 to 60 participants, 2 to 5 conditions), `small` (as many conditions + 1 to 7), `ties` (the same, few distinct integers, so that many
differences are zero or equal), `rates` (success rates of 20 episodes, as a study has them) or `degenerate` (constant
columns, equal columns, columns a constant apart: values that do not exist are recorded as NaN or Infinity).
"""
import itertools, json, sys
import numpy as np, pandas as pd, pingouin as pg, scipy.stats as st
import record_statistics


def recorded(y):
    """The case of a given table: `record_statistics.case` with its random draw replaced."""

    class Given:
        def normal(self, size):
            return np.zeros(size)

        def uniform(self, *_):
            return 0.0

    kept = np.round
    np.round = lambda *_: y
    try:
        return record_statistics.case(Given(), *y.shape, ties=False)
    finally:
        np.round = kept


def draw(rng, kind):
    n, k = int(rng.integers(8, 61)), int(rng.integers(2, 6))
    if kind == "small":
        n = int(rng.integers(k + 1, 8))
    if kind in ("shapes", "small"):
        return np.round(5 + rng.normal(size=(n, 1)) * 3 + rng.normal(size=(n, k)) * rng.uniform(.1, 4, k) + rng.normal(size=k), 4)
    if kind == "ties":
        return np.round(3 + rng.normal(size=(n, 1)) + rng.normal(size=(n, k)) * rng.uniform(.3, 1.5))
    if kind == "rates":
        return rng.binomial(20, np.clip(rng.beta(4, 2, size=(n, 1)) + rng.normal(size=k) * .1, 0, 1)) / 20
    y = np.round(rng.normal(size=(n, max(k, 3))) * 2)  # with two conditions pingouin's ANOVA has no F to record
    which = rng.integers(4)
    if which == 0:
        y[:, 1] = y[:, 0]
    elif which == 1:
        y[:, 1] = y[:, 0] + 2
    elif which == 2:
        y[:, 1] = y[:, 0] + .25
    else:
        y[:, 0], y[:, 1] = 1.0, 1.0
    return y


if __name__ == "__main__":
    out, seed, cases, kind = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    rng = np.random.default_rng(seed)
    data = [recorded(draw(rng, kind)) for _ in range(cases)]
    json.dump(dict(pingouin=pg.__version__, numpy=np.__version__, cases=data), open(out, "w"), default=float)
    print(out, len(data), "cases")
