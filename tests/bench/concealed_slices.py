#!/usr/bin/env python3
"""Calibrations of box slices whose parameters are drawn at random and concealed. Needs Python 3 alone.

  concealed_slices.py BUILD_DIR WORK_DIR CASE.toml [--draws 1,2,3] [--methods enc,spe,map] [--truth density,sound_speed,tensile_cutoff]
                      [--set table.key=value]... [--name NAME] [--threads N] [--finished]

CASE gives target, load, gauges and bounds. For each draw the parameters are drawn (density from 10 500 to 13 500, sound speed from 1200 to 1650, the logarithm of the
cutoff from 5e4 to 8e5), and examples/recorder/make_recordings plays the experiment on 0.6 or 0.7 times the case's elements with other viscosities, another
time step, a steel whose modulus is 1.5 % (sd) off, gauges 0.3 mm and gains 1 % off, pulses of unequal energy and coloured noise. Then every method calibrates. With --truth
the records of CASE itself are used, made with these parameters. NAME tells studies of one WORK_DIR with other settings apart: they share records and campaigns. A call that is
cut off goes on where it stopped; --finished calibrates nothing and tabulates what stands: distances from the truth in percent +- the method's own deviation, in brackets in deviations.
"""
import argparse
import json
import math
import os
import random
import re
import sys

from calibration_spread import answer, copy_missing, run


def arguments():
    p = argparse.ArgumentParser()
    p.add_argument("build")
    p.add_argument("work")
    p.add_argument("case")
    p.add_argument("--draws", default="1")
    p.add_argument("--methods", default="enc,spe,map")
    p.add_argument("--truth")
    p.add_argument("--set", action="append", default=[], dest="overrides")
    p.add_argument("--name", default="calibration")
    p.add_argument("--threads", default="2")
    p.add_argument("--finished", action="store_true")
    return p.parse_args()


def drawn(draw, sensors, case_young):
    """Parameters, and the truth file of make_recordings. Odd draws are recorded in one way, even ones in another."""
    r = random.Random(draw)
    truth = {"density": r.uniform(10500, 13500), "sound_speed": r.uniform(1200, 1650), "tensile_cutoff": math.exp(r.uniform(math.log(5e4), math.log(8e5)))}
    young = case_young * (1 + 0.015 * r.gauss(0, 1))
    way = {"element": 0.6, "safety": 0.7, "eta": 1000, "least": 0.15} if draw % 2 else {"element": 0.7, "safety": 0.9, "eta": 3000, "least": 0.08}
    lines = ["[parameter]"] + [f"{n} = {v:.6g}" for n, v in truth.items()]
    lines += ["[experiment]", f"seed = {draw}", 'precision = "single"', f"element_size_ratio = {way['element']}", f"time_step_safety = {way['safety']}",
              "sample_interval = 1e-6", "energy_sd = 0.015", "noise_time = 5e-6", "resolution = 1e-8", "place_sd = 0.3e-3", "gain_sd = 0.01",
              f'unlike = ["material.steel.young={young:.6g}", "material.mercury.regularising_viscosity={way["eta"]}", '
              f'"material.mercury.least_mesh_viscosity={way["least"]}"]']
    lines += ["[pulses]"] + [f"{s} = {r.choice((10, 12, 14))}" for s in sensors]
    lines += ["[noise]"] + [f"{s} = {r.choice((5e-6, 5e-6, 5e-6, 12e-6))}" for s in sensors]
    return {n: float(f"{v:.6g}") for n, v in truth.items()}, "\n".join(lines) + "\n"


def study(args, recordings, base, out):
    """The calibrations of one draw; campaign and surrogate stand in `base`, for every name."""
    sets = [x for o in args.overrides for x in ("--set", o)]
    program = os.path.join(args.build, "apps", "calomel")
    common = ["--threads", args.threads, "--quiet"] + (["--set", f'recordings.file="{recordings}"'] if recordings else [])
    log = os.path.join(args.work, "calibrations.log")
    if not os.path.exists(os.path.join(base, "train.json")):
        for verb in ("campaign", "train"):
            run([program, verb, args.case, "--out", base] + common + sets, log)
    os.makedirs(out, exist_ok=True)
    copy_missing(base, out)
    methods = [x for m in args.methods.split(",") for x in ("--method", m)]
    run([program, "calibrate", args.case, "--out", out] + methods + common + sets, log)
    copy_missing(out, base)


def print_table(found):
    names = ("density", "sound_speed", "impedance", "tensile_cutoff")
    print("\n| records | method | density | sound speed | ρc | σc (logarithm) | model runs | passes |\n|---|---|---|---|---|---|---|---|")
    zs = {}
    for (label, method), (r, truth) in found.items():
        cells = []
        for n in names:
            v, sd = r["value"][n], r["sd"].get(n, float("nan"))
            if n == "tensile_cutoff":
                off, dev, form = math.log(v / truth[n]), sd / v, "{:+.3f} ± {:.3f} ({:.1f})"
            else:
                off, dev, form = 100 * (v / truth[n] - 1), 100 * sd / truth[n], "{:+.1f} ± {:.1f} % ({:.1f})"
            cells.append(form.format(off, dev, abs(off / dev)))
            zs.setdefault(method, []).append(off / dev)
        print(f"| {label} | {method.upper()} | " + " | ".join(cells) + f" | {r['model_runs']} | {'yes' if r['passes'] else 'no'} |")
    for method, z in zs.items():
        print(f"\n{method.upper()}: rms of z {math.sqrt(sum(x * x for x in z) / len(z)):.2f}, mean of abs z {sum(map(abs, z)) / len(z):.2f}, greatest {max(map(abs, z)):.1f}")


def main():
    args = arguments()
    args.work, args.build, args.case = (os.path.abspath(p) for p in (args.work, args.build, args.case))
    os.makedirs(args.work, exist_ok=True)
    text_of_case = open(args.case).read()
    sensors = re.findall(r'\[\[sensor\]\]\s*\n\s*name\s*=\s*"([^"]+)"', text_of_case)
    young = float(re.search(r"^young\s*=\s*([-+.\deE]+)", text_of_case, re.M).group(1))
    work = []
    if args.truth:
        work.append(("the case's", None, dict(zip(("density", "sound_speed", "tensile_cutoff"), map(float, args.truth.split(","))))))
    else:
        for draw in map(int, args.draws.split(",")):
            truth, text = drawn(draw, sensors, young)
            recordings = os.path.join(args.work, f"records_{draw}.nc")
            if not os.path.exists(recordings) and not args.finished:
                path = os.path.join(args.work, f"truth_{draw}.toml")
                with open(path, "w") as f:
                    f.write(text)
                recorder = os.path.join(args.build, "examples", "recorder", "make_recordings")
                run([recorder, args.case, path, recordings + ".part"], os.path.join(args.work, "recordings.log"))
                os.rename(recordings + ".part", recordings)
            work.append((f"draw {draw}", recordings, truth))
    found = {}
    for label, recordings, truth in work:
        truth["impedance"] = truth["density"] * truth["sound_speed"]
        place = "own" if recordings is None else label.replace(" ", "_")
        out = os.path.join(args.work, f"{place}_{args.name}")
        if not args.finished:
            study(args, recordings, os.path.join(args.work, place), out)
        for m in args.methods.split(","):
            if os.path.exists(os.path.join(out, m + ".json")):
                found[label, m] = answer(out, m, truth), truth
                print(label, m, "done", file=sys.stderr, flush=True)
    print_table(found)


if __name__ == "__main__":
    main()
