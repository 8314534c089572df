#!/usr/bin/env python3
"""Draws suites of concealed-physics cases for reference_generator. Needs Python 3 alone.

  draw_suite.py OUT_DIR --seed S [--none 60] [--single 5] [--outside 5] [--sensor 5] [--pair 8] [--effects beam,rear_layer] [--generate GENERATOR [--threads N]]

--single and --outside count per effect, --effects keeps to some of them. Writes OUT_DIR/specs/case_NNN.toml in shuffled order, so that a name tells nothing; with --generate also runs the
generator: OUT_DIR/cases/case_NNN (what a user would have) and OUT_DIR/truth/case_NNN.toml. What is there is not made again, so a call that is cut off goes on where it stopped. A suite depends on
its seed and counts alone; case k of one seed is drawn from its own stream.
"""
import argparse
import math
import os
import random
import subprocess
import sys

STEP = 0.5e-3  # every edge of a target lies on a grid of this spacing


def on_grid(value):
    return round(STEP * round(value / STEP), 6)


def log_uniform(r, low, high):
    return math.exp(r.uniform(math.log(low), math.log(high)))


def sign(r):
    return r.choice((-1, 1))


class Target:
    def __init__(self, r):
        self.length, self.height = on_grid(r.uniform(0.09, 0.11)), on_grid(r.uniform(0.032, 0.040))
        self.front, self.top, self.bottom = (on_grid(r.uniform(0.003, 0.005)) for _ in range(3))
        self.gauges = []
        for i, share in enumerate((0.14, 0.32, 0.52, 0.75)):
            self.gauges.append((f"T{i + 1}", self.length * (share + r.uniform(-0.04, 0.04)), self.height, "x"))
        for i, share in enumerate((0.2, 0.45, 0.7)):
            self.gauges.append((f"B{i + 1}", self.length * (share + r.uniform(-0.04, 0.04)), 0.0, "x"))
        self.gauges.append(("F1", 0.0, self.height * r.uniform(0.45, 0.6), "z"))
        self.gauges = [(n, round(x, 4), round(z, 4), d) for n, x, z, d in self.gauges]

    def stretch(self, r, wall, shortest, longest):
        """Begin and length of a stretch of a wall, away from the corners, and how many times as long it may become."""
        if wall == "front":
            length, low, high = on_grid(r.uniform(0.3, 0.6) * (self.height - self.top - self.bottom)), self.bottom + 0.002, self.height - self.top - 0.002
        else:
            length, low, high = on_grid(r.uniform(shortest, longest)), self.front + 0.004, self.length - 0.008
        begin = on_grid(r.uniform(low, high - length))
        return begin, length, (high - begin) / length

    def free_place(self, r, wall):
        """A place on the top or bottom wall, 5 mm from its gauges."""
        along = [x for n, x, _, _ in self.gauges if n[0] == {"top": "T", "bottom": "B"}[wall]]
        while True:
            place = on_grid(r.uniform(0.015, self.length - 0.02))
            if all(abs(place - x) > 0.005 for x in along):
                return place


def draw_effect(name, t, r):
    """Numbers of an effect at scale 1, and the greatest scale that is still credible."""
    wall = r.choice(("top", "bottom"))
    if name == "beam":
        what = r.sample(("offset_z", "width_ratio", "energy_ratio", "pulse_length_ratio"), r.choice((1, 2, 3)))
        if not {"offset_z", "width_ratio"} & set(what):
            what.append(r.choice(("offset_z", "width_ratio")))
        all_numbers = {"offset_z": sign(r) * r.uniform(1e-3, 3e-3), "width_ratio": math.exp(sign(r) * r.uniform(0.05, 0.12)), "energy_ratio": math.exp(sign(r) * r.uniform(0.01, 0.02)),
                       "pulse_length_ratio": r.uniform(1.5, 2.5)}
        return {k: v for k, v in all_numbers.items() if k in what}, 1.8
    if name == "rear_layer":
        return {"impedance_ratio": math.exp(sign(r) * r.uniform(0.5, 1.5)), "speed": r.uniform(900, 1500), "thickness": 0.01}, 2.5
    if name == "bubbles":
        return {"small_fraction": log_uniform(r, 1e-5, 1e-4), "large_fraction": log_uniform(r, 1e-5, 1e-4), "small_radius": log_uniform(r, 1e-5, 4e-5), "large_radius": log_uniform(r, 6e-5, 3e-4),
                "ambient": r.uniform(1e5, 3e5), "viscosity": log_uniform(r, 0.05, 0.5)}, 20
    if name == "nucleation":
        return {"number": log_uniform(r, 3e6, 1e8), "radius": 1e-5}, 20
    if name == "relaxing_liquid":
        return {"viscosity": log_uniform(r, 2000, 8000), "time": log_uniform(r, 0.5e-6, 4e-6)}, 8
    if name == "zener_steel":
        return {"loss": r.uniform(0.01, 0.02), "frequency": log_uniform(r, 8e3, 4e4)}, 4
    if name == "heated_steel":
        return {"rise": r.uniform(0.5, 1), "depth": log_uniform(r, 0.015, 0.06), "expansion": 16e-6}, 3
    if name == "tait":
        return {"stiffening": r.uniform(8, 12)}, 1.3
    if name == "debonding":
        wall = r.choice(("top", "bottom", "front"))
        begin, length, most = t.stretch(r, wall, 0.015, 0.03)
        return {"wall": wall, "begin": begin, "length": length, "strength": r.choice((0.0, r.uniform(0, 5e4)))}, most
    if name == "thinning":
        wall = r.choice(("top", "bottom", "front"))
        begin, length, _ = t.stretch(r, wall, 0.01, 0.025)
        return {"wall": wall, "begin": begin, "length": length, "fraction": r.uniform(0.15, 0.3)}, 2
    if name == "residual_ringing":
        return {"amplitude": sign(r) * r.uniform(0.1, 0.3), "after": r.uniform(3e-4, 5e-4)}, 3
    if name == "gauge_fault":
        fault = r.choice(("gain", "delay", "low_pass", "angle"))
        value = {"gain": math.exp(sign(r) * r.uniform(0.08, 0.15)), "delay": sign(r) * r.uniform(1e-6, 2e-6), "low_pass": log_uniform(r, 2e4, 1e5), "angle": r.uniform(8, 15)}[fault]
        return {"gauge": r.choice(t.gauges)[0], fault: value}, 2.5
    if name == "yielding":
        return {"stress": r.uniform(6e7, 1.2e8), "hardening": r.uniform(1e9, 4e9)}, 6
    if name == "rib":
        return {"wall": wall, "place": t.free_place(r, wall), "thickness": 0.003, "height": on_grid(r.uniform(0.004, 0.01))}, 2
    if name == "gas_pocket":
        begin, length, _ = t.stretch(r, "top", 0.008, 0.02)
        return {"wall": "top", "begin": begin, "length": length, "thickness": log_uniform(r, 2e-6, 2e-5)}, 20
    if name == "speed_gradient":
        return {"change": sign(r) * r.uniform(0.05, 0.1)}, 3
    if name == "added_mass":
        begin, length, _ = t.stretch(r, wall, 0.015, 0.04)
        return {"wall": wall, "begin": begin, "length": length, "mass": r.uniform(5, 15)}, 10
    if name == "slot":
        return {"wall": wall, "place": t.free_place(r, wall), "width": 0.5e-3, "depth": r.uniform(0.3, 0.6) * getattr(t, wall)}, 1.6
    raise KeyError(name)


LIBRARY = ("beam", "rear_layer", "bubbles", "nucleation", "relaxing_liquid", "zener_steel", "heated_steel", "tait", "debonding", "thinning", "residual_ringing")
OUTSIDE = ("yielding", "rib", "gas_pocket", "speed_gradient", "added_mass", "slot")
PAIRS = (("beam", "rear_layer"), ("beam", "bubbles"), ("rear_layer", "zener_steel"), ("beam", "gauge_fault"), ("rear_layer", "gauge_fault"), ("bubbles", "rear_layer"),
         ("beam", "zener_steel"), ("bubbles", "gauge_fault"), ("thinning", "beam"), ("nucleation", "beam"))


def number(v):
    return f'"{v}"' if isinstance(v, str) else f"{float(v):.8g}" if "." in f"{float(v):.8g}" or "e" in f"{float(v):.8g}" else f"{float(v):.8g}.0"


def table(name, values):
    return f"[{name}]\n" + "".join(f"{k} = {v if isinstance(v, int) else number(v)}\n" for k, v in values.items()) + "\n"


def spec(name, effects, r, grid):
    t = Target(r)
    noise = r.choice((2e-6, 3e-6, 4e-6))
    text = table("case", {"name": name, "seed": r.randrange(2**31), "grid": grid})
    text += table("geometry", {"length": t.length, "height": t.height, "front": t.front, "top": t.top, "bottom": t.bottom})
    text += table("steel", {"young": 193e9 * (1 + 0.015 * max(-2, min(2, r.gauss(0, 1)))), "density": 7960.0, "poisson": 0.29})
    text += table("mercury", {"density": r.uniform(13250, 13590), "sound_speed": r.uniform(1405, 1490), "tensile_cutoff": log_uniform(r, 8e4, 4e5), "viscosity": log_uniform(r, 500, 4000)})
    text += table("load", {"peak_pressure": round(r.uniform(20e6, 30e6), -5), "center": round(t.height * r.uniform(0.45, 0.55), 4), "width": round(t.height * r.uniform(0.3, 0.42), 4),
                           "pulse_length": 0.7e-6 * r.uniform(0.9, 1.1)})
    text += table("time", {"end": round(r.uniform(0.22e-3, 0.26e-3), 6), "interval": 1e-6})
    text += table("pulses", {"count": r.randint(18, 24), "energy": 1 + 0.01 * r.gauss(0, 1), "energy_sd": 0.015})
    text += table("gauges", {"place_sd": 0.3e-3, "gain_sd": 0.01, "noise_time": log_uniform(r, 2e-6, 8e-6)})
    for n, x, z, d in t.gauges:
        text += table("[gauge]", {"name": n, "x": x, "z": z, "direction": d, "length": 0.002, "noise": noise * r.choice((1, 1, 1, 1, 1, 3))})
    greatest = 1e9
    for e in effects:
        values, limit = draw_effect(e, t, r)
        greatest = min(greatest, limit)
        text += table("[effect]", {"name": e} | values)
    if effects and effects != ["tait"]:  # a real liquid's curvature is no matter of choice
        text += table("strength", {"target": 0.02 * log_uniform(r, 1, 8), "greatest_scale": greatest, "least_scale": 1e-3})
    return text


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("out")
    p.add_argument("--seed", type=int, required=True)
    p.add_argument("--none", type=int, default=60)
    p.add_argument("--single", type=int, default=5, help="per effect that the library has a mechanism for")
    p.add_argument("--outside", type=int, default=5, help="per effect that it has none for")
    p.add_argument("--sensor", type=int, default=5)
    p.add_argument("--pair", type=int, default=8)
    p.add_argument("--effects", type=lambda s: s.split(","), help="keep to these")
    p.add_argument("--grid", type=float, default=0.25e-3)
    p.add_argument("--generate", metavar="GENERATOR")
    p.add_argument("--threads", type=int, default=1)
    args = p.parse_args()
    wanted = args.effects or LIBRARY + OUTSIDE
    if unknown := set(wanted) - set(LIBRARY + OUTSIDE):
        sys.exit(f"no effect is called {', '.join(sorted(unknown))}; there are {', '.join(LIBRARY + OUTSIDE)}")
    cases = [[] for _ in range(args.none)] + [["gauge_fault"] for _ in range(args.sensor)]
    cases += [[e] for e in LIBRARY if e in wanted for _ in range(args.single)] + [[e] for e in OUTSIDE if e in wanted for _ in range(args.outside)]
    cases += [list(PAIRS[k % len(PAIRS)]) for k in range(args.pair)]
    random.Random(f"order {args.seed}").shuffle(cases)
    for folder in ("specs", "cases", "truth") if args.generate else ("specs",):
        os.makedirs(os.path.join(args.out, folder), exist_ok=True)
    for k, effects in enumerate(cases):
        name = f"case_{k + 1:03d}"
        path = os.path.join(args.out, "specs", name + ".toml")
        with open(path, "w") as f:
            f.write(spec(name, effects, random.Random(f"suite {args.seed} case {k}"), args.grid))
        truth = os.path.join(args.out, "truth", name + ".toml")
        if args.generate and not os.path.exists(truth):
            done = subprocess.run([args.generate, path, os.path.join(args.out, "cases", name), "--truth", truth, "--threads", str(args.threads)], capture_output=True, text=True)
            with open(os.path.join(args.out, "truth", name + ".log"), "w") as f:
                f.write(done.stdout + done.stderr)
            print(f"{name}: {'failed, ' + done.stderr.strip() if done.returncode else done.stdout.strip().splitlines()[-1]}", flush=True)
    print(f"{len(cases)} cases of seed {args.seed}: {sum(not c for c in cases)} with nothing concealed")


if __name__ == "__main__":
    main()
