#!/usr/bin/env python3
"""Spread of the calibrations of 02_box_slice over seeds and over noise realisations. Needs Python 3 alone.

  calibration_spread.py BUILD_DIR WORK_DIR [--seeds 20] [--noises 5] [--full] [--methods enc,spe,map] [--set table.key=value]... [--threads N]

Noise realisations are recordings made anew from the same truth with other seeds; seeds are those of the campaign's design, the training and the searches.
By default every seed meets the first realisation and every realisation the first seed; --full takes all pairs. A call that is cut off goes on where it
stopped. It ends with a Markdown table of mean and standard deviation, in percent of the truth, and for MAP of the distance in its own deviations.
"""
import argparse
import json
import math
import os
import re
import shutil
import subprocess
import sys


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
    for name in ("campaign.nc", "campaign.json", "surrogate.nc", "train.json", "floor.json"):
        if os.path.exists(os.path.join(base, name)) and not os.path.exists(os.path.join(out, name)):
            shutil.copyfile(os.path.join(base, name), os.path.join(out, name))
    methods = [x for m in args.methods.split(",") for x in ("--method", m)]
    run([program, "calibrate", case, "--out", out, "--set", f'recordings.file="{recordings}"'] + methods + common, log)
    if os.path.exists(os.path.join(out, "floor.json")) and not os.path.exists(os.path.join(base, "floor.json")):
        shutil.copyfile(os.path.join(out, "floor.json"), os.path.join(base, "floor.json"))


def answers(out, method, names):
    j = json.load(open(os.path.join(out, method + ".json")))
    values = dict(j["theta"])
    values["impedance"] = values["density"] * values["sound_speed"]
    values["accuracy"], values["mae"] = j["accuracy"], j["mae"]
    sds = {}
    if "covariance" in j:
        c, p = j["covariance"], j["parameters"]
        for i, n in enumerate(p):
            sds[n] = math.sqrt(c[i][i])
        r, s = p.index("density"), p.index("sound_speed")
        v = values["sound_speed"] ** 2 * c[r][r] + values["density"] ** 2 * c[s][s] + 2 * values["density"] * values["sound_speed"] * c[r][s]
        sds["impedance"] = math.sqrt(v)
    return values, sds


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
    truth = {n: float(re.search(rf"^{n} = (\S+)", truth_text, re.M).group(1)) for n in ("density", "sound_speed", "tensile_cutoff")}
    truth["impedance"] = truth["density"] * truth["sound_speed"]
    pairs = [(s, k) for s in range(1, args.seeds + 1) for k in range(args.noises) if args.full or s == 1 or k == 0]
    recorder = os.path.join(args.build, "examples", "recorder", "make_recordings")
    found = {}
    for s, k in pairs:
        out = os.path.join(args.work, f"pair_{s}_{k}")
        study(args, case, s, realisation(k, truth_text, case, recorder, args.work), out)
        found[s, k] = out
        print(f"seed {s}, noise {k} done", flush=True)
    groups = [("all", pairs), ("seeds, first noise", [p for p in pairs if p[1] == 0]), ("noises, first seed", [p for p in pairs if p[0] == 1])]
    print("\n| method | over | n | " + " | ".join(f"{n} [% off]" for n in truth) + " | accuracy [%] | mae | rms of (answer - truth) / sd |\n|" + "---|" * (len(truth) + 6))
    for method in args.methods.split(","):
        for name, group in groups:
            results = [answers(found[p], method, truth) for p in group]
            cells = []
            for n in truth:
                m, sd = mean_sd([100 * (v[n] / truth[n] - 1) for v, _ in results])
                cells.append(f"{m:+.2f} ± {sd:.2f}")
            for n in ("accuracy", "mae"):
                m, sd = mean_sd([v[n] for v, _ in results])
                cells.append(f"{m:.1f} ± {sd:.1f}")
            pulls = [((v[n] - truth[n]) / e[n]) ** 2 for v, e in results for n in e]
            cells.append(f"{math.sqrt(sum(pulls) / len(pulls)):.1f}" if pulls else "")
            print(f"| {method.upper()} | {name} | {len(group)} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
