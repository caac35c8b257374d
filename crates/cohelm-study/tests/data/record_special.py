#!/usr/bin/env python3
"""Reference values of the special functions, with 400 digits (tails are differences) before they are rounded once to f64.

    pip install mpmath==1.4.1
    python record_special.py special.json

beta: rows [a, b, x, 1 - x, I_x(a, b)]; gamma_upper: rows [a, x, Q(a, x)]; normal_cdf: rows [z, Phi(z)].
"""
import json, sys
import mpmath as mp

mp.mp.dps = 400


def beta_rows():
    for a in (0.5, 1.0, 1.5, 4.5, 9.0, 14.5, 43.5, 500.0):
        for b in (0.5, 1.0, 1.5, 2.0, 9.0, 58.0):
            for x in (1e-9, 0.001, 0.05, 0.25, 0.5, 0.75, 0.96875, 0.9990234375):
                x = mp.mpf(float(x))
                # The complement must be the f64 that the code sees: these x are chosen so that 1 - x is (nearly) exact.
                y = mp.mpf(float(1 - x))
                # An f64 pair (x, y) need not add up to one exactly: take the end that is farther from its bound.
                value = mp.betainc(a, b, 0, x, regularized=True) if x < y else 1 - mp.betainc(b, a, 0, y, regularized=True)
                if 1e-290 < value:
                    yield [a, b, float(x), float(y), float(value)]


def gamma_rows():
    for a in (0.5, 1.0, 1.5, 2.0, 3.5, 4.5, 9.0, 27.0):
        for x in (1e-6, 0.01, 0.3, 0.9, 1.4, 2.5, 3.7, 5.0, 9.5, 14.0, 27.5, 60.0, 200.0, 600.0):
            yield [a, x, float(mp.gammainc(a, mp.mpf(float(x)), mp.inf, regularized=True))]


def normal_rows():
    for i in range(-36, 9):
        z = mp.mpf(i)
        yield [float(z), float(mp.erfc(-z / mp.sqrt(2)) / 2)]


if __name__ == "__main__":
    rows = dict(beta=list(beta_rows()), gamma_upper=list(gamma_rows()), normal_cdf=list(normal_rows()))
    text = ",\n".join(f' "{k}": [\n  ' + ",\n  ".join(json.dumps(r) for r in v) + "\n ]" for k, v in rows.items())
    open(sys.argv[1], "w").write("{\n" + text + "\n}\n")
    print({k: len(v) for k, v in rows.items()})
