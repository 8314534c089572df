#!/usr/bin/env python3
"""Makes record.csv: the cantilever of beam_server.py with air drag that the base model leaves out. Its own formula: classical Runge-Kutta steps of 0.02 ms, a third
bending mode, gauges with gains of their own, six drops with noise.

usage: make_record.py > record.csv
"""
import math, random

FREQUENCY, DAMPING, DRAG = 9.83, 0.0041, 0.0022
RATIOS, RELEASED = (1.0, 6.267, 17.55), (4.0, 0.3, 0.001)
STRAIN = {"root": (50.0, 210.0, 560.0), "middle": (17.0, -120.0, -160.0)}
GAIN = {"root": 1.004, "middle": 0.994}
STEP, EVERY, COUNT, DROPS, NOISE = 2e-5, 250, 200, 6, 3.0

def slope(state):
    out = []
    for m, ratio in enumerate(RATIOS):
        w = 2 * math.pi * FREQUENCY * ratio
        x, v = state[2 * m], state[2 * m + 1]
        out += [v, -w * w * x - 2 * DAMPING * w * v - DRAG * abs(v) * v]
    return out

state = [n for x in RELEASED for n in (x, 0.0)]
true = {name: [] for name in STRAIN}
for k in range(EVERY * (COUNT - 1) + 1):
    if k % EVERY == 0:
        for name, gauge in STRAIN.items():
            true[name].append(GAIN[name] * sum(g * state[2 * m] for m, g in enumerate(gauge)))
    a = slope(state)
    b = slope([s + STEP / 2 * d for s, d in zip(state, a)])
    c = slope([s + STEP / 2 * d for s, d in zip(state, b)])
    d = slope([s + STEP * e for s, e in zip(state, c)])
    state = [s + STEP / 6 * (p + 2 * q + 2 * r + t) for s, p, q, r, t in zip(state, a, b, c, d)]

random.seed(20261)
print("sensor,pulse,time,strain")
for drop in range(DROPS):
    for name, record in true.items():
        for i, value in enumerate(record):
            print(f"{name},{drop},{0.005 * i:.4g},{value + random.gauss(0, NOISE):.5g}")
