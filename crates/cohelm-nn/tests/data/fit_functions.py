"""Minimax polynomials behind `cohelm_nn::math`.

Run:  pip install mpmath && python fit_functions.py

exp:   P with exp(r) = 1 + r + r^2 P(r), |r| <= ln(2)/2
tanh:  Q with tanh(x) = x + x^3 Q(x^2), 0 <= x <= 0.625

Lawson's iteration (reweighted least squares that tends to the least maximum of the relative error) in 40 digits. The
coefficients are rounded to f32 one after the other, lowest first, and the rest fitted again after each rounding, so
that the later ones make up for the rounding of the earlier ones.
"""

import struct

from mpmath import expm1, linspace, log, lu_solve, matrix, mp, mpf, nstr, exp, tanh

mp.dps = 40


def f32(x):
    return mpf(struct.unpack("f", struct.pack("f", float(x)))[0])


def fit(target, weight, grid, fixed, degree):
    free = range(len(fixed), degree + 1)
    lawson = [mpf(1)] * len(grid)
    for _ in range(40):
        normal, rhs = matrix(len(free), len(free)), matrix(len(free), 1)
        for x, v in zip(grid, lawson):
            s = weight(x) ** 2 * v
            rest = target(x) - sum(c * x**i for i, c in enumerate(fixed))
            for a, i in enumerate(free):
                rhs[a] += s * x**i * rest
                for b, j in enumerate(free):
                    normal[a, b] += s * x ** (i + j)
        coefficients = list(fixed) + list(lu_solve(normal, rhs))
        error = [weight(x) * abs(target(x) - sum(c * x**i for i, c in enumerate(coefficients))) for x in grid]
        total = sum(v * e for v, e in zip(lawson, error))
        lawson = [v * e / total * len(grid) for v, e in zip(lawson, error)]
    return coefficients, max(error)


def report(name, target, weight, low, high, degree):
    fixed = []
    grid = linspace(low, high, 200)
    for _ in range(degree + 1):
        coefficients, error = fit(target, weight, grid, fixed, degree)
        fixed.append(f32(coefficients[len(fixed)]))
    print(name, "relative error", nstr(error, 3), [float(c) for c in fixed])


half = log(2) / 2 * mpf("1.0001")
report(
    "exp",
    lambda r: (expm1(r) - r) / r**2 if r else mpf(1) / 2,
    lambda r: r**2 / exp(r),
    -half,
    half,
    4,
)
report(
    "tanh",
    lambda z: (tanh(mp.sqrt(z)) / mp.sqrt(z) - 1) / z,
    lambda z: z / (tanh(mp.sqrt(z)) / mp.sqrt(z)),
    mpf(10) ** -9,
    mpf("0.625") ** 2,
    4,
)
