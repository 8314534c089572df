#!/usr/bin/env python3
"""Writes reference.json: stored chains with R-hat, effective sample sizes and Monte Carlo errors by the formulas of Vehtari et al. 2021,
written a second time, straight from the paper and without a Fourier transform, so that the C++ functions are held against numbers that they did not make.

    python3 tests/unit/uq/convergence/reference.py > tests/unit/uq/convergence/reference.json
"""
import json
import math
import random
from statistics import NormalDist

PHI = NormalDist()


def split(chains):
    out = []
    for c in chains:
        half = len(c) // 2
        out += [c[:half], c[len(c) - half:]]
    return out


def scores(chains):
    flat = sorted(v for c in chains for v in c)
    first, count = {}, {}
    for i, v in enumerate(flat):
        first.setdefault(v, i + 1)
        count[v] = count.get(v, 0) + 1
    s = len(flat)
    return [[PHI.inv_cdf((first[v] + (count[v] - 1) / 2 - 3 / 8) / (s + 1 / 4)) for v in c] for c in chains]


def mean(x):
    return math.fsum(x) / len(x)


def var(x):
    m = mean(x)
    return math.fsum((v - m) ** 2 for v in x) / (len(x) - 1)


def quantile(chains, p):
    flat = sorted(v for c in chains for v in c)
    place = p * (len(flat) - 1)
    k = int(place)
    return flat[k] if k + 1 == len(flat) else flat[k] + (place - k) * (flat[k + 1] - flat[k])


def r_hat_basic(chains):
    n = len(chains[0])
    b = n * var([mean(c) for c in chains])
    w = mean([var(c) for c in chains])
    return math.sqrt(((n - 1) / n * w + b / n) / w)


def r_hat(chains):
    median = quantile(chains, 0.5)
    folded = [[abs(v - median) for v in c] for c in chains]
    return max(r_hat_basic(split(scores(chains))), r_hat_basic(split(scores(folded))))


def ess(chains):
    m, n = len(chains), len(chains[0])
    means = [mean(c) for c in chains]
    w = mean([var(c) for c in chains])
    plus = (n - 1) / n * w + var(means)

    def rho(t):
        if t == 0:
            return 1.0
        autocovariance = mean([math.fsum((c[i] - mu) * (c[i + t] - mu) for i in range(n - t)) / n for c, mu in zip(chains, means)])
        return 1 - (w - autocovariance) / plus

    pairs = []  # (rho(2k), rho(2k + 1)), initial positive sequence
    k = 0
    even, odd = rho(0), rho(1)
    pairs.append([even, odd])
    while 2 * k < n - 5 and even + odd > 0:
        k += 1
        even, odd = rho(2 * k), rho(2 * k + 1)
        pairs.append([even, odd] if even + odd >= 0 else [0.0, 0.0])
    if even > 0:
        pairs[-1][0] = even
    for j in range(1, len(pairs) - 1):  # initial monotone sequence
        if sum(pairs[j]) > sum(pairs[j - 1]):
            pairs[j] = [sum(pairs[j - 1]) / 2] * 2
    tau = -1 + 2 * math.fsum(sum(p) for p in pairs[:-1]) + pairs[-1][0]
    total = m * n
    return total / max(tau, 1 / math.log10(total))


def ess_quantile(chains, p):
    q = quantile(chains, p)
    return ess(split([[1.0 if v <= q else 0.0 for v in c] for c in chains]))


def beta_quantile(p, a, b):
    """By bisection on a fine Simpson integral of the density."""
    lognorm = math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
    density = lambda x: 0.0 if x <= 0 or x >= 1 else math.exp(lognorm + (a - 1) * math.log(x) + (b - 1) * math.log1p(-x))
    centre, width = a / (a + b), math.sqrt(a * b / (a + b) ** 2 / (a + b + 1))
    start = max(0.0, centre - 12 * width)

    def cdf(x):
        steps = 4000
        h = (x - start) / steps
        return h / 3 * math.fsum((1 if i in (0, steps) else 4 if i % 2 else 2) * density(start + i * h) for i in range(steps + 1))

    low, high = start, min(1.0, centre + 12 * width)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if cdf(middle) < p else (low, middle)
    return (low + high) / 2


def mcse_quantile(chains, p):
    n = ess_quantile(chains, p)
    flat = sorted(v for c in chains for v in c)
    s = len(flat)
    low = flat[max(math.floor(s * beta_quantile(PHI.cdf(-1), n * p + 1, n * (1 - p) + 1)), 1) - 1]
    high = flat[min(math.ceil(s * beta_quantile(PHI.cdf(1), n * p + 1, n * (1 - p) + 1)), s) - 1]
    return (high - low) / 2


def mcse_sd(chains):
    flat = [v for c in chains for v in c]
    m = mean(flat)
    square = [[(v - m) ** 2 for v in c] for c in chains]
    m2, m4 = mean([v for c in square for v in c]), mean([v * v for c in square for v in c])
    return math.sqrt((m4 - m2 ** 2) / ess(split(square)) / m2) / 2


def numbers(chains):
    flat = [v for c in chains for v in c]
    return {"r_hat": r_hat(chains), "ess_bulk": ess(split(scores(chains))), "ess_tail": min(ess_quantile(chains, 0.05), ess_quantile(chains, 0.95)),
            "ess_mean": ess(split(chains)), "mcse_mean": math.sqrt(var(flat) / ess(split(chains))), "mcse_sd": mcse_sd(chains),
            "mcse_q05": mcse_quantile(chains, 0.05), "mcse_median": mcse_quantile(chains, 0.5)}


def autoregressive(r, coefficient, n, shift=0.0, scale=1.0):
    x, chain = r.gauss(0, 1), []
    for _ in range(n):
        x = coefficient * x + math.sqrt(1 - coefficient ** 2) * r.gauss(0, 1)
        chain.append(round(shift + scale * x, 5))
    return chain


def main():
    r = random.Random(20210601)
    cases = {
        "independent": [autoregressive(r, 0.0, 120) for _ in range(4)],
        "slow": [autoregressive(r, 0.9, 150) for _ in range(4)],
        "antithetic": [autoregressive(r, -0.3, 120) for _ in range(4)],
        "antithetic beyond the cap": [autoregressive(r, -0.7, 100) for _ in range(4)],
        "apart": [autoregressive(r, 0.3, 100, shift=1.5 * (k % 2)) for k in range(4)],
        "one wider": [autoregressive(r, 0.0, 100, scale=3.0 if k == 3 else 1.0) for k in range(4)],
        "heavy tails": [[round(math.tan(math.pi * (r.random() - 0.5)), 5) for _ in range(120)] for _ in range(4)],
        "ties and an odd number": [[float(round(2 * v)) for v in autoregressive(r, 0.5, 101)] for _ in range(3)],
        "one chain": [autoregressive(r, 0.6, 200)],
    }
    print(json.dumps({name: {"chains": chains, **numbers(chains)} for name, chains in cases.items()}, separators=(",", ":")).replace('},"', '},\n"'))


main()
