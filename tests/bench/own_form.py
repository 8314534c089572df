#!/usr/bin/env python3
"""Diagnoses of targets whose concealed physics has the library's own form. Needs Python 3 alone.

  own_form.py record   BUILD_DIR WORK_DIR --draws 1,2,3 [--target slice|jet_flow|small_jet_flow|bench_jet_flow] [--element 0.5e-3] [--threads N]
  own_form.py diagnose BUILD_DIR WORK_DIR --draws 1,2,3 [--threads N] [--set table.key=value]...
  own_form.py table    WORK_DIR --draws 1,2,3 [--target slice|jet_flow|small_jet_flow|bench_jet_flow]

`calomel challenge` asks whether physics of another code, in another form than the library's, is named. Where a name is missed there it may be the form or the engine. Here the form is right: draw n conceals
mechanism n modulo 10 of a list (nothing at 0; what is added to the histories, earlier pulses and faults of a gauge, is linear in the engine and not among them), with numbers drawn within its ranges, and make_recordings plays the experiment with this solver on elements of `--element`, another time step, and a
modulus, viscosity, energy, gauge places, gains and noise as in tests/bench/concealed_slices.py. Targets are box slices, or half of a jet-flow target in three dimensions with twelve gauges, for which there is no other code (small_jet_flow: one half as long, wide and high, which costs a fifth; bench_jet_flow: one as long and
high as the slices, which elements of 2.5 and 1.5 mm resolve as they do a slice). What is missed here is missed by the engine, or lies below what the records can tell. `table` gives the strength of each
effect (as the challenge does: relative L2 of the mean records with and without it after a Hann window of 50 us, mean over the gauges, by ensemble means on the case's own mesh), the verdict, and the numbers beside the true ones.
A call that is cut off goes on where it stopped.
"""
import argparse
import json
import math
import os
import random
import re
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from concealed_slices import CASE, PARAMETERS, SENSOR, call  # noqa: E402

PULSES = 16


def log_uniform(r, low, high):
    return math.exp(r.uniform(math.log(low), math.log(high)))


def either_way(r, low, high):
    return r.choice((-1, 1)) * r.uniform(low, high)


def stretch(r, target, wall, least, most):
    extent = target["height"] if wall == "front" else target["length"]
    length = r.uniform(0.3, 0.6) * extent if wall == "front" else r.uniform(least, most)
    begin = r.uniform(0.1 * extent, 0.9 * extent - length)
    return begin, begin + length


def wall_part(r, target, least, most):
    wall = r.choice(("top", "bottom", "front"))
    begin, end = stretch(r, target, wall, least, most)
    return {"wall": f'"{wall}"', "begin": begin, "end": end}


def beam(r, _):
    keys = {"offset_z": either_way(r, 1e-3, 3e-3), "width_ratio_z": math.exp(either_way(r, 0.05, 0.12)), "energy_ratio": 1 + either_way(r, 0.01, 0.02), "pulse_length": r.uniform(1e-6, 1.8e-6)}
    first = r.choice(("offset_z", "width_ratio_z"))
    return {k: v for k, v in keys.items() if k == first or r.random() < 0.4}


EFFECTS = (
    ("none", None),
    ("beam_profile", beam),
    ("rear_reflection", lambda r, _: {"coefficient": either_way(r, 0.05, 0.4)}),
    ("bubbly_liquid", lambda r, _: {"alpha0": log_uniform(r, 1e-5, 3e-4), "radius": log_uniform(r, 3e-5, 2e-4), "ambient_pressure": r.uniform(1e5, 3e5)}),
    ("cavitation_kinetics", lambda r, _: {k: log_uniform(r, 2e-6, 3e-5) for k in r.choice((("growth_time",), ("collapse_time",), ("growth_time", "collapse_time")))}),
    ("structural_damping", lambda r, _: {"loss": r.uniform(0.01, 0.05), "frequency": log_uniform(r, 8e3, 4e4)}),
    ("thermal_stress", lambda r, _: {"delta_t": r.uniform(0.4, 1.5), "decay": log_uniform(r, 0.02, 0.08)}),
    ("interface", lambda r, t: {"strength": r.choice((0.0, r.uniform(0, 5e4))), **wall_part(r, t, 0.02, 0.05)}),
    ("wall_thinning", lambda r, t: {"fraction": r.uniform(0.1, 0.3), **wall_part(r, t, 0.012, 0.03)}),
    ("liquid_viscosity", lambda r, _: {"zeta": log_uniform(r, 3e3, 1e4)}),
    ("cavitation_kinetics", lambda r, _: {"nuclei_spacing": log_uniform(r, 4e-4, 3e-3)}),
)


def slice_target(r, draw):
    """The case, the target that effects are drawn for, and the peak pressure."""
    length, height = 0.001 * r.randrange(90, 111), 0.001 * r.randrange(32, 41)
    front, top, bottom = (0.001 * r.choice((3, 4, 5)) for _ in range(3))
    gauges, sensors = [], ""
    for name, x, z, direction in ([(f"T{i + 1}", length * (s + r.uniform(-0.04, 0.04)), height, "[1, 0, 0]") for i, s in enumerate((0.14, 0.32, 0.52, 0.75))]
                                  + [(f"B{i + 1}", length * (s + r.uniform(-0.04, 0.04)), 0, "[1, 0, 0]") for i, s in enumerate((0.2, 0.45, 0.7))]
                                  + [("F1", 0, height * r.uniform(0.45, 0.6), "[0, 0, 1]")]):
        gauges.append(name)
        sensors += SENSOR.format(name=name, x=x, z=z, direction=direction)
    target = {"length": length, "height": height, "gauges": gauges}
    peak = r.uniform(20e6, 30e6)
    case = CASE.format(draw=draw, length=length, height=height, front=front, top=top, bottom=bottom, peak=peak, middle=height * r.uniform(0.45, 0.55), width=height * r.uniform(0.3, 0.42), sensors=sensors)
    return case, target, peak


# Ranges of a jet-flow target's dimensions and of its beam's widths, coarser and finer elements [m], time and interval of its records [s].
JET_FLOW = {"length": (0.5, 0.6), "width": (0.36, 0.44), "height": (0.10, 0.14), "walls": (0.004, 0.005, 0.006), "wide": (0.05, 0.065), "high": (0.017, 0.023), "channel": 0.02, "plate": 0.005, "coarse": 0.010, "fine": 0.007, "end": 0.3e-3, "interval": "2e-6"}
SMALL_JET_FLOW = {"length": (0.25, 0.3), "width": (0.18, 0.22), "height": (0.05, 0.07), "walls": (0.003, 0.00375, 0.0045), "wide": (0.025, 0.0325), "high": (0.0085, 0.0115), "channel": 0.01, "plate": 0.0025, "coarse": 0.007, "fine": 0.005, "end": 0.2e-3, "interval": "2e-6"}
BENCH_JET_FLOW = {"length": (0.09, 0.11), "width": (0.06, 0.08), "height": (0.032, 0.041), "walls": (0.003, 0.0035, 0.004), "wide": (0.011, 0.015), "high": (0.011, 0.015), "channel": 0.005, "plate": 0.002, "coarse": 0.0025, "fine": 0.0015, "end": 0.2e-3, "interval": "1e-6"}


def jet_target(r, draw, of):
    """The same of half a jet-flow target within the ranges `of`; places and directions of the gauges are about those of examples/03_jet_flow."""
    length, width, height, wall = r.uniform(*of["length"]), r.uniform(*of["width"]), r.uniform(*of["height"]), r.choice(of["walls"])
    gauges, sensors = [], ""
    for name, x, y, top, direction in JET_GAUGES:
        gauges.append(name)
        place = (length * (x + r.uniform(-0.02, 0.02)), 0.0 if y == 0 else width * (y + r.uniform(-0.02, 0.02)), height if top else 0.0)
        sensors += '[[sensor]]\nname = "{}"\nposition = [{:.4f}, {:.4f}, {:.4f}]\ndirection = {}\ngauge_length = {}\n'.format(name, *place, direction, min(0.006, 2 * of["fine"]))
    peak = r.uniform(20e6, 30e6)
    case = JET.format(draw=draw, length=length, width=width, height=height, wall=wall, peak=peak, middle=height * r.uniform(0.45, 0.55), wide=r.uniform(*of["wide"]), high=r.uniform(*of["high"]), sensors=sensors,
                      **{k: of[k] for k in ("channel", "plate", "coarse", "fine", "end", "interval")})
    return case, {"length": length, "height": height, "gauges": gauges}, peak


JET = """[case]
name = "concealed jet-flow target {draw}"
[geometry]
kind = "jet_flow"
half = true
rear = "non_reflecting"
length = {length:.4f}
width = {width:.4f}
height = {height:.4f}
wall = {wall}
window = 0.003
element_size = {coarse}
[geometry.jet]
channel = {channel}
thickness = {plate}
[material.mercury]
density = 13500.0
sound_speed = 1450.0
tensile_cutoff = 1.5e5
[load]
kind = "initial_pressure"
peak_pressure = {peak:.4e}
profile = {{ center = [0.0, {middle:.4f}], widths = [{wide:.4f}, {high:.4f}] }}
[time]
end = {end}
output_interval = {interval}
[solver]
precision = "single"
{sensors}[recordings]
file = "records_{draw}.nc"
[campaign]
pulses = 1
[emulator]
element_sizes = [{coarse}, {fine}]
"""
# Name, place along and across in lengths and widths, whether on top, direction.
JET_GAUGES = (("B", 0.18, 0, True, "[1, 0, 0]"), ("C", 0.27, 0.15, True, "[0, 1, 0]"), ("E", 0.24, 0.30, True, "[1, 1, 0]"), ("F", 0.40, 0, True, "[1, 0, 0]"), ("G", 0.47, 0.25, True, "[0, 1, 0]"),
              ("M", 0.60, 0.12, True, "[1, 0, 0]"), ("R", 0.16, 0.08, False, "[1, 0, 0]"), ("T", 0.22, 0.22, False, "[0, 1, 0]"), ("U", 0.33, 0, False, "[0, 1, 0]"), ("V", 0.36, 0.32, False, "[1, -1, 0]"),
              ("Y", 0.51, 0.15, False, "[1, 0, 0]"), ("Z", 0.65, 0.28, False, "[1, 1, 0]"))


def whole_wall(r):
    return {"wall": f'"{r.choice(("top", "bottom", "front"))}"'}


JET_EFFECTS = (
    ("none", None),
    ("beam_profile", lambda r, t: {"offset_z": t["height"] * either_way(r, 0.01, 0.035), "width_ratio_z": math.exp(either_way(r, 0.05, 0.12))}),
    ("rear_reflection", lambda r, _: {"coefficient": either_way(r, 0.2, 0.6)}),
    ("bubbly_liquid", lambda r, _: {"alpha0": log_uniform(r, 3e-5, 3e-4), "radius": log_uniform(r, 3e-5, 2e-4), "ambient_pressure": r.uniform(1e5, 3e5)}),
    ("none", None),
    ("structural_damping", lambda r, _: {"loss": r.uniform(0.03, 0.08), "frequency": log_uniform(r, 8e3, 4e4)}),
    ("interface", lambda r, _: {"strength": r.uniform(0, 5e4), **whole_wall(r)}),
    ("wall_thinning", lambda r, _: {"fraction": r.uniform(0.1, 0.3), **whole_wall(r)}),
)
# What makes the target, its effects, the case's element size and that of the records [m].
TARGETS = {"slice": (slice_target, EFFECTS, 0.001, 0.0005), **{name: (lambda r, draw, of=of: jet_target(r, draw, of), JET_EFFECTS, of["coarse"], element)
                                                            for name, of, element in (("jet_flow", JET_FLOW, 0.005), ("small_jet_flow", SMALL_JET_FLOW, 0.0035), ("bench_jet_flow", BENCH_JET_FLOW, 0.00075))}}


def draw_case(draw, kind, element):
    """The case, the truth file of make_recordings, its [parameter], and the mechanism with its numbers."""
    make, effects, own_element, _ = TARGETS[kind]
    r = random.Random(f"own form {draw}" if kind == "slice" else f"own form {kind} {draw}")
    case, target, peak = make(r, draw)
    case += PARAMETERS.format(density=(1350.0, 13600.0), speed=(500.0, 4000.0))
    true = {"density": r.uniform(13250, 13590), "sound_speed": r.uniform(1405, 1490), "tensile_cutoff": log_uniform(r, 8e4, 4e5)}
    unlike = [f"material.steel.young={193e9 * (1 + 0.015 * max(-2, min(2, r.gauss(0, 1)))):.6g}", f"material.mercury.regularising_viscosity={log_uniform(r, 500, 4000):.6g}",
              "material.mercury.least_mesh_viscosity=0", f"load.peak_pressure={peak * (1 + 0.01 * r.gauss(0, 1)):.6g}", f"load.pulse_length={0.7e-6 * r.uniform(0.9, 1.1):.6g}"]
    name, numbers = effects[draw % len(effects)]
    numbers = numbers(r, target) if numbers else {}
    unlike += concealed(name, numbers)
    lines = ["[parameter]"] + [f"{n} = {v:.8g}" for n, v in true.items()]
    lines += ["[experiment]", f"seed = {r.randrange(10**6)}", 'precision = "single"', f"element_size_ratio = {element / own_element:.4g}", f"time_step_safety = {r.choice((0.7, 0.8, 0.9))}", "sample_interval = " + re.search(r"output_interval = (\S+)", case).group(1),
              "energy_sd = 0.015", f"noise_time = {log_uniform(r, 2e-6, 8e-6):.4g}", "resolution = 1e-8", "place_sd = 0.3e-3", "gain_sd = 0.01", "unlike = [" + ", ".join(f"'{u}'" for u in unlike) + "]"]
    noise = r.choice((2e-6, 3e-6, 4e-6))
    lines += ["[pulses]"] + [f"{s} = {PULSES}" for s in target["gauges"]] + ["[noise]"] + [f"{s} = {noise * (3 if r.randrange(6) == 0 else 1)}" for s in target["gauges"]]
    return case, "\n".join(lines) + "\n", true, name, numbers


def concealed(name, numbers):
    return [] if name == "none" else [f"mechanism.{name}.enabled=true"] + [f"mechanism.{name}.{k}={v if isinstance(v, str) else format(v, '.8g')}" for k, v in numbers.items()]


def folder(args, draw):
    return os.path.join(args.work, f"case_{draw:03d}")


def record(args):
    for draw in args.draws:
        place = folder(args, draw)
        records = os.path.join(place, f"records_{draw}.nc")
        if os.path.exists(records):
            continue
        os.makedirs(place, exist_ok=True)
        case, truth, true, name, numbers = draw_case(draw, args.target, args.element)
        for end, text in (("case.toml", case), ("truth.toml", truth)):
            with open(os.path.join(place, end), "w") as f:
                f.write(text)
        call([os.path.join(args.build, "examples", "recorder", "make_recordings"), os.path.join(place, "case.toml"), os.path.join(place, "truth.toml"), records + ".part"], os.path.join(place, "log"))
        program = os.path.join(args.build, "apps", "calomel")
        for what, extra in (("without", []), ("with", concealed(name, numbers))):
            sets = [x for s in [f"material.mercury.{n}={v:.8g}" for n, v in true.items()] + extra for x in ("--set", s)]
            call([program, "simulate", os.path.join(place, "case.toml"), "--mean", "--quiet", "--out", os.path.join(place, what), "--threads", str(args.threads), *sets], os.path.join(place, "log"))
        os.rename(records + ".part", records)


def diagnose(args):
    for draw in args.draws:
        place = folder(args, draw)
        if not os.path.exists(os.path.join(place, "out", "diagnosis.json")):
            call([os.path.join(args.build, "apps", "calomel"), "diagnose", os.path.join(place, "case.toml"), "--quiet", "--out", os.path.join(place, "out"), "--threads", str(args.threads)]
                 + [x for s in args.set for x in ("--set", s)], os.path.join(place, "log"))


def histories(path):
    """strain(sensor, time) of a simulate.nc, by ncdump."""
    text = subprocess.run(["ncdump", "-v", "strain,time", "-p", "9,17", path], check=True, capture_output=True, text=True).stdout
    values = {}
    for name in ("strain", "time"):
        body = re.search(rf"\n {name} =(.*?);", text[text.index("data:"):], re.S).group(1)
        values[name] = [float(x) for x in body.replace("\n", " ").split(",")]
    n = len(values["time"])
    return [values["strain"][i:i + n] for i in range(0, len(values["strain"]), n)]


def smooth(x, half=25):
    weights = [0.5 * (1 + math.cos(math.pi * k / half)) for k in range(-half, half + 1)]
    out = []
    for i in range(len(x)):
        pairs = [(w, x[i + k - half]) for k, w in enumerate(weights) if 0 <= i + k - half < len(x)]
        out.append(sum(w * v for w, v in pairs) / sum(w for w, _ in pairs))
    return out


def strength(place):
    shares = []
    for a, b in zip(histories(os.path.join(place, "without", "simulate.nc")), histories(os.path.join(place, "with", "simulate.nc"))):
        a, b = smooth(a), smooth(b)
        shares.append(math.sqrt(sum((x - y) ** 2 for x, y in zip(a, b)) / sum(x * x for x in a)))
    return sum(shares) / len(shares)


def table(args):
    print("| draw | concealed | strength | verdict | log Bayes factor, lead | chi-squared | base parameters, deviations from the truth | numbers (true) | runs |\n|---|---|---|---|---|---|---|---|---|")
    for draw in args.draws:
        place = folder(args, draw)
        path = os.path.join(place, "out", "diagnosis.json")
        if not os.path.exists(path):
            continue
        with open(path) as f:
            d = json.load(f)
        _, _, true, name, numbers = draw_case(draw, args.target, args.element)
        after = d["base_parameters"]["after"]
        off = ", ".join(f"{(after[n]['mean'] - t) / after[n]['sd']:+.1f}" for n, t in true.items())
        ranked = [r for r in d["ranking"] if r["name"] not in ("none", "unknown")]
        ranked.sort(key=lambda r: -(r.get("log_bayes_factor") or -1e9))
        best = ranked[0]
        lead = best["log_bayes_factor"] - max([0] + [r["log_bayes_factor"] for r in ranked[1:2]])
        own = next((r for r in ranked if r["name"] == name), None)
        numbers_text = ", ".join(f"{p['name'].split('.', 1)[-1]} {p['mean'] if p['mean'] is None else format(p['mean'], '.3g')} ± {p['sd']:.2g}" for p in (own or {"parameters": []})["parameters"] if p["sd"] is not None)
        concealed_numbers = ", ".join(f"{k} {v if isinstance(v, str) else format(v, '.3g')}" for k, v in numbers.items())
        print(f"| {draw} | {name} | {100 * strength(place):.1f} % | {d['verdict']} {' '.join(d['mechanisms'])} | {best['name']} {best['log_bayes_factor']:.1f}, {lead:.1f}"
              + (f"; {name} {own['log_bayes_factor']:.1f}" if own and own is not best else "") + f" | {d['evidence']['chi2']:.0f} to {own['chi2'] if own and own['chi2'] is not None else math.nan:.0f} of {d['evidence']['values']:.0f}"
              + f" | {off} | {numbers_text} ({concealed_numbers}) | {d.get('runs', 0)} |")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("what", choices=("record", "diagnose", "table"))
    p.add_argument("places", nargs="+", metavar="BUILD_DIR WORK_DIR")
    p.add_argument("--draws", required=True, type=lambda s: [int(x) for part in s.split(",") for x in (range(int(part.split("-")[0]), int(part.split("-")[1]) + 1) if "-" in part else [part])])
    p.add_argument("--target", choices=tuple(TARGETS), default="slice")
    p.add_argument("--element", type=float, help="of the records [m]; default half of the finer one that is diagnosed with")
    p.add_argument("--set", action="append", default=[])
    p.add_argument("--threads", type=int, default=1)
    args = p.parse_args()
    args.element = args.element or TARGETS[args.target][3]
    args.work, args.build = os.path.abspath(args.places[-1]), os.path.abspath(args.places[0])
    os.makedirs(args.work, exist_ok=True)
    {"record": record, "diagnose": diagnose, "table": table}[args.what](args)


if __name__ == "__main__":
    main()
