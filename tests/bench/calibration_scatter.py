#!/usr/bin/env python3
"""Spread of the calibrations of 02_box_slice over seeds and over noise realisations. Needs Python 3 alone.

  calibration_scatter.py BUILD_DIR WORK_DIR [--seeds 20] [--noises 5] [--full] [--methods enc,spe,map] [--set table.key=value]... [--threads N] [--finished]

Noise realisations are recordings made anew from the same truth with other seeds; seeds are those of the campaign's design, the training and the searches.
By default every seed meets the first realisation and every realisation the first seed; --full takes all pairs. A call that is cut off goes on where it
stopped; --finished calibrates nothing and tabulates what stands. After each pair calibrations.csv in WORK_DIR holds a row for every calibration so far. It ends with a Markdown table of mean and standard deviation, in
percent of the truth; for methods that report a covariance of the distance in their own deviations (over the three parameters and the impedance), and how many
pass: the impedance within 1 % or two reported deviations, whichever is more, and the logarithm of the cutoff within 0.25.
"""
import argparse
import csv
import json
import math
import os
import re
import shutil
import subprocess
import sys
import time

PARAMETERS = ("density", "sound_speed", "tensile_cutoff")


def arguments():
    p = argparse.ArgumentParser()
    p.add_argument("build")
    p.add_argument("work")
    p.add_argument("--seeds", type=int, default=20)
    p.add_argument("--noises", type=int, default=5)
    p.add_argument("--full", action="store_true")
    p.add_argument("--methods", default="enc,spe,map")
    p.add_argument("--set", action="append", default=[], dest="overrides")
    p.add_argument("--threads", default="2")
    p.add_argument("--finished", action="store_true")
    return p.parse_args()


def run(command, log):
    with open(log, "a") as out:
        status = subprocess.run(command, stdout=out, stderr=out).returncode
    if status not in (0, 4):
        sys.exit(f"exit status {status}: {' '.join(command)}\nsee {log}")


def realisation(k, truth, case, program, work):
    """Recordings of noise seed 20 + k; 20 is the committed one."""
    path = os.path.join(work, f"noise_{k}.nc")
    if not os.path.exists(path):
        other = os.path.join(work, f"truth_{k}.toml")
        with open(other, "w") as f:
            f.write(re.sub(r"^seed = \d+", f"seed = {20 + k}", truth, flags=re.M))
        run([program, case, other, path + ".part"], os.path.join(work, "recordings.log"))
        os.rename(path + ".part", path)
    return path


def copy_missing(source, target):
    """What calibrations share: campaign, surrogate and repeatability floor."""
    for name in ("campaign.nc", "campaign.json", "surrogate.nc", "train.json", "floor.json"):
        if os.path.exists(os.path.join(source, name)) and not os.path.exists(os.path.join(target, name)):
            shutil.copyfile(os.path.join(source, name), os.path.join(target, name))


def study(args, case, seed, recordings, out):
    """The calibrations of one pair; the campaign and the surrogate are those of the seed."""
    sets = [x for o in args.overrides for x in ("--set", o)]
    base = os.path.join(args.work, f"seed_{seed}")
    program = os.path.join(args.build, "apps", "calomel")
    common = ["--seed", str(seed), "--threads", args.threads, "--quiet"] + sets
    log = os.path.join(args.work, "calibrations.log")
    for verb in ("campaign", "train"):
        run([program, verb, case, "--out", base] + common, log)
    os.makedirs(out, exist_ok=True)
    copy_missing(base, out)
    methods = [x for m in args.methods.split(",") for x in ("--method", m)]
    run([program, "calibrate", case, "--out", out, "--set", f'recordings.file="{recordings}"'] + methods + common, log)
    copy_missing(out, base)


def answer(out, method, truth):
    """What one calibration found: values and, where it reports a covariance, their standard deviations."""
    with open(os.path.join(out, method + ".json")) as f:
        j = json.load(f)
    value = {n: j["theta"][n] for n in PARAMETERS}
    value["impedance"] = value["density"] * value["sound_speed"]
    sd = {}
    if j.get("covariance"):
        c, place = j["covariance"], {n: i for i, n in enumerate(j["parameters"])}
        slopes = {n: {n: 1} for n in PARAMETERS}
        slopes["impedance"] = {"density": value["sound_speed"], "sound_speed": value["density"]}
        for n, slope in slopes.items():
            sd[n] = math.sqrt(sum(slope[a] * slope[b] * c[place[a]][place[b]] for a in slope for b in slope))
    off = value["impedance"] / truth["impedance"] - 1
    allowed = max(0.01, 2 * sd["impedance"] / truth["impedance"]) if sd else 0.01
    passes = abs(off) < allowed and abs(math.log(value["tensile_cutoff"] / truth["tensile_cutoff"])) < 0.25
    return {"value": value, "sd": sd, "accuracy": j["accuracy"], "mae": j["mae"], "model_runs": j["model_runs"], "passes": passes}


def write_rows(path, found, truth):
    """A row for each calibration: values in percent off the truth, reported deviations in percent of it."""
    with open(path + ".part", "w", newline="") as f:
        w = csv.writer(f)
        w.writerow(["method", "seed", "noise"] + [f"{n}_off_percent" for n in truth] + [f"{n}_sd_percent" for n in truth] +
                   ["accuracy_percent", "mae_microstrain", "model_runs", "passes"])
        for (method, seed, noise), r in sorted(found.items()):
            off = [f"{100 * (r['value'][n] / truth[n] - 1):.4f}" for n in truth]
            sd = [f"{100 * r['sd'][n] / truth[n]:.4f}" if r["sd"] else "" for n in truth]
            w.writerow([method, seed, noise] + off + sd + [f"{r['accuracy']:.3f}", f"{r['mae']:.3f}", r["model_runs"], int(r["passes"])])
    os.replace(path + ".part", path)


def mean_sd(xs):
    m = sum(xs) / len(xs)
    return m, math.sqrt(sum((x - m) ** 2 for x in xs) / (len(xs) - 1)) if len(xs) > 1 else float("nan")


def main():
    args = arguments()
    args.work, args.build = os.path.abspath(args.work), os.path.abspath(args.build)
    os.makedirs(args.work, exist_ok=True)
    examples = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples")
    case = os.path.join(examples, "02_box_slice", "box_slice.toml")
    truth_text = open(os.path.join(examples, "recorder", "box_slice.truth.toml")).read()
    truth = {n: float(re.search(rf"^{n} = (\S+)", truth_text, re.M).group(1)) for n in PARAMETERS}
    truth["impedance"] = truth["density"] * truth["sound_speed"]
    pairs = [(s, k) for s in range(1, args.seeds + 1) for k in range(args.noises) if args.full or s == 1 or k == 0]
    recorder = os.path.join(args.build, "examples", "recorder", "make_recordings")
    methods = args.methods.split(",")
    found = {}
    for s, k in pairs:
        out, begun = os.path.join(args.work, f"pair_{s}_{k}"), time.monotonic()
        if not args.finished:
            study(args, case, s, realisation(k, truth_text, case, recorder, args.work), out)
            print(f"seed {s}, noise {k} done in {time.monotonic() - begun:.0f} s", flush=True)
        for m in methods:
            if not args.finished or os.path.exists(os.path.join(out, m + ".json")):
                found[m, s, k] = answer(out, m, truth)
        write_rows(os.path.join(args.work, "calibrations.csv"), found, truth)
    print_table(found, methods, truth)


def print_table(found, methods, truth):
    heads = [f"{n} [% off]" for n in truth] + ["accuracy [%]", "mae", "passes", "mean of abs z", "rms of z"]
    print("\n| method | over | n | " + " | ".join(heads) + " |\n|" + "---|" * (len(heads) + 3))
    for method in methods:
        of = {(s, k): r for (m, s, k), r in found.items() if m == method}
        for name, group in (("all", list(of)), ("seeds, first noise", [p for p in of if p[1] == 0]), ("noises, first seed", [p for p in of if p[0] == 1])):
            results = [of[p] for p in group]
            if not results:
                continue
            cells = []
            for n in truth:
                m, sd = mean_sd([100 * (r["value"][n] / truth[n] - 1) for r in results])
                cells.append(f"{m:+.2f} ± {sd:.2f}")
            for n in ("accuracy", "mae"):
                m, sd = mean_sd([r[n] for r in results])
                cells.append(f"{m:.1f} ± {sd:.1f}")
            cells.append(f"{sum(r['passes'] for r in results)} of {len(results)}")
            z = [(r["value"][n] - truth[n]) / r["sd"][n] for r in results for n in r["sd"]]
            cells.append(f"{sum(map(abs, z)) / len(z):.2f}" if z else "")
            cells.append(f"{math.sqrt(sum(x * x for x in z) / len(z)):.2f}" if z else "")
            print(f"| {method.upper()} | {name} | {len(group)} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
