#!/usr/bin/env python3
"""Elements of higher order, with the cutoff and without: a column of mercury between two sprung steel walls. Needs Debian's python3-numpy.

  spectral_column.py [--collapse 0.5]

One dimension: steel 4 mm, mercury 35.2 mm, steel 3 mm, each wall on a spring (8 and 12 kHz), heated by 25 MPa in 0.7 us, 0.24 ms, mean of eight energies. The mercury is divided into elements of order p with
Gauss-Lobatto nodes, masses lumped at them and the law taken at them, with the solver's viscosity of liquid that closes (h: length a node); p = 1 is the solver's element. Walls part as in the solver; the steel has 0.25 mm. Error: velocity of both walls decimated to 20 kHz
against p = 1 on 0.05 mm, before and after 112 us. Cost: nodes of the mercury times its own stable steps in 1 us.
"""
import argparse

import numpy as np
from numpy.polynomial import legendre

from mesh_error import decimated

DENSITY, SPEED, VISCOSITY, HEAT, LENGTH = 13500.0, 1450.0, 2000.0, 25e6, 0.0352
STIFFNESS = DENSITY * SPEED**2
STEEL_DENSITY, STEEL_MODULUS = 7960.0, 193e9 * (1 - 0.29) / ((1 + 0.29) * (1 - 2 * 0.29))
WALLS, SPRINGS, STEEL_SIZE = (4e-3, 3e-3), (8e3, 12e3), 0.25e-3
ENERGIES = np.array([0.97699, 0.98669, 0.99267, 0.99764, 1.00236, 1.00733, 1.01331, 1.02301])
OUTPUT, SAMPLES = 1e-6, 240


def mercury(size, p):
    """Masses, the matrix of strains at the points of the law, and their weights; `size` is that of a node's share."""
    if p == 1:
        points, weights, slope = np.array([-1, 1.0]), np.array([1, 1.0]), np.array([[-0.5, 0.5]])
        law_weights = np.array([2.0])
    else:
        c = np.eye(p + 1)[p]
        points = np.concatenate([[-1], np.sort(legendre.legroots(legendre.legder(c)).real), [1]])
        value = legendre.legval(points, c)
        weights = law_weights = 2 / (p * (p + 1) * value**2)
        with np.errstate(divide="ignore"):
            slope = value[:, None] / value / (points[:, None] - points)
        np.fill_diagonal(slope, 0)
        slope[0, 0], slope[p, p] = -p * (p + 1) / 4, p * (p + 1) / 4
    elements = max(2, round(LENGTH / (size * p)))
    h = LENGTH / elements
    mass, rows = np.zeros(elements * p + 1), len(slope)
    strain = np.zeros((elements * rows, elements * p + 1))
    for e in range(elements):
        mass[e * p:e * p + p + 1] += DENSITY * weights * h / 2
        strain[e * rows:(e + 1) * rows, e * p:e * p + p + 1] = slope * 2 / h
    return mass, strain, np.tile(law_weights * h / 2, elements)


def solve(size, p, cutoff, collapse):
    """Velocities of the outer faces, (2, samples), and the cost."""
    mass, strain, weight = mercury(size, p)
    beta, closing = VISCOSITY / STIFFNESS, collapse * DENSITY * SPEED * size * (cutoff < STIFFNESS)
    greatest = np.sqrt(np.linalg.eigvalsh(STIFFNESS * (strain.T * weight) @ strain / np.sqrt(np.outer(mass, mass))).max())
    damping = 0.5 * (beta + closing / STIFFNESS) * greatest
    liquid_step = 2 / greatest * (np.sqrt(1 + damping**2) - damping)
    per_output = int(np.ceil(OUTPUT / (0.95 * min(liquid_step, STEEL_SIZE / np.sqrt(STEEL_MODULUS / STEEL_DENSITY)))))
    dt = OUTPUT / per_output
    walls = []
    for side, (thickness, frequency) in enumerate(zip(WALLS, SPRINGS)):
        n = round(thickness / STEEL_SIZE)
        m = np.full(n + 1, STEEL_DENSITY * thickness / n)
        m[[0, -1]] /= 2
        walls.append({"m": m, "k": STEEL_MODULUS * n / thickness, "spring": (2 * np.pi * frequency) ** 2 * STEEL_DENSITY * thickness, "u": np.zeros((n + 1, 8)), "v": np.zeros((n + 1, 8)),
                      "open": np.zeros(8), "outer": -side, "inner": side - 1, "wet": -side, "sign": 2 * side - 1})
    u, v = np.zeros((len(mass), 8)), np.zeros((len(mass), 8))
    out, opened = np.zeros((2, SAMPLES + 1)), np.zeros((len(weight), 8), bool)
    for step in range(SAMPLES * per_output + 1):
        if step % per_output == 0:
            out[:, step // per_output] = [w["u"][w["outer"]].mean() for w in walls]
        kick = dt if step else dt / 2
        load = HEAT * min(1, step * dt / 0.7e-6) * ENERGIES
        rate = strain @ v
        pressure = np.maximum(load - STIFFNESS * (strain @ u) - VISCOSITY * rate, -cutoff)
        at_cutoff = pressure <= -cutoff
        pressure -= closing * rate * (opened & (rate < 0) & ~at_cutoff)
        opened |= at_cutoff
        v += kick * (strain.T @ (weight[:, None] * pressure)) / mass[:, None]
        for w in walls:
            force = np.zeros_like(w["u"])
            stress = w["k"] * np.diff(w["u"], axis=0)
            force[:-1] += stress
            force[1:] -= stress
            force[w["outer"]] -= w["spring"] * w["u"][w["outer"]]
            w["v"] += kick * force / w["m"][:, None]
            # The pair: together while the pull stays below the cutoff, apart until the gap is gone.
            a, b, sign = mass[w["wet"]], w["m"][w["inner"]], w["sign"]
            vm, vs, gap = sign * v[w["wet"]], sign * w["v"][w["inner"]], sign * (w["u"][w["inner"]] - u[w["wet"]])
            common, was = (a * vm + b * vs) / (a + b), w["open"]
            apart = np.maximum(was, a / kick * (common - vm) > cutoff)
            pull = kick * cutoff * apart
            meets = gap + dt * (vs - pull / b - vm - pull / a) <= 0
            now = np.where(meets, 0.0, apart)
            after = -was * meets * gap / dt
            v[w["wet"]] = sign * np.where(now == 1, vm + pull / a, common - b / (a + b) * after)
            w["v"][w["inner"]] = sign * np.where(now == 1, vs - pull / b, common + a / (a + b) * after)
            w["open"] = now
        u += dt * v
        for w in walls:
            w["u"] += dt * w["v"]
    return np.gradient(out, axis=1), (len(mass) - 1) * int(np.ceil(OUTPUT / (0.95 * liquid_step)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--collapse", default=0.5, type=float)
    collapse = parser.parse_args().collapse
    print("| | mm a node | p | cost | first 112 us | after |\n|---|---|---|---|---|---|")
    for words, cutoff in (("linear", 1e12), ("cutoff", 1.5e5)):
        fine = decimated(solve(0.05e-3, 1, cutoff, collapse)[0])
        for size in (4e-3, 2e-3, 1e-3, 0.5e-3):
            for p in (1, 2, 3, 4):
                velocity, cost = solve(size, p, cutoff, collapse)
                d = decimated(velocity)
                early, late = (100 * np.mean(np.linalg.norm((d - fine)[:, s], axis=1) / np.linalg.norm(fine[:, s], axis=1)) for s in (slice(0, 4), slice(4, None)))
                print(f"| {words} | {1e3 * size:g} | {p} | {cost} | {early:.2f} % | {late:.2f} % |", flush=True)


if __name__ == "__main__":
    main()
