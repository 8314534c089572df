#!/usr/bin/env python3
"""What the regularising viscosity and the number of pulses in the mean cost and buy: repeatability floor, change of the answer and time, as Markdown.

  viscosity_and_pulses.py BUILD_DIR WORK_DIR CASE.toml [--factors 0.25,0.5,1,2,4] [--pulses 1,2,4,8,16] [--set table.key=value]... [--threads N]
  viscosity_and_pulses.py BUILD_DIR WORK_DIR CASE.toml --precision [--set ...]
  viscosity_and_pulses.py BUILD_DIR WORK_DIR CASE.toml --memory H1,H2,... [--set ...]

A row is `check --floor` of that setting (the jitters alone, of which the viscosity is halved and doubled as ever) and `simulate --mean` on one thread. The
change of the answer is |f - f0| / |f0| in the L2 norm over the record, f0 the setting with factor 1 and 8 pulses: mean over the gauges and the worst. Time is
processor time. --precision compares single with double precision, of one run and of the mean of 8; --memory gives the greatest resident size of one run of
a single output interval by element, for each element size. Seeds are fixed; what is finished is kept, a call that was cut off goes on. Needs numpy and netCDF4.
"""
import argparse
import json
import os
import subprocess
import sys

import netCDF4
import numpy as np


def arguments():
    p = argparse.ArgumentParser()
    p.add_argument("build")
    p.add_argument("work")
    p.add_argument("case")
    p.add_argument("--factors", default="0.25,0.5,1,2,4")
    p.add_argument("--pulses", default="1,2,4,8,16")
    p.add_argument("--set", action="append", default=[], dest="overrides")
    p.add_argument("--threads", default="1")
    p.add_argument("--precision", action="store_true")
    p.add_argument("--memory", default="")
    return p.parse_args()


class Measured:
    """One command, its usage kept beside its output."""

    def __init__(self, args, name, words):
        self.out = os.path.join(args.work, name)
        kept = os.path.join(self.out, "usage.json")
        if not os.path.exists(kept):
            os.makedirs(self.out, exist_ok=True)
            sets = [x for o in args.overrides for x in ("--set", o)]
            command = [os.path.join(args.build, "apps", "calomel")] + words[:1] + [args.case, "--out", self.out, "--quiet", "--threads", args.threads] + sets + words[1:]
            with open(os.path.join(self.out, "log"), "w") as log:
                process = subprocess.Popen(command, stdout=log, stderr=log)
                _, status, usage = os.wait4(process.pid, 0)
            if status != 0:
                sys.exit(f"{' '.join(command)}\nended with {status}, see {self.out}/log")
            with open(kept, "w") as f:
                json.dump({"processor_s": usage.ru_utime + usage.ru_stime, "resident_bytes": usage.ru_maxrss * 1024}, f)
        with open(kept) as f:
            self.usage = json.load(f)

    def json(self, name):
        with open(os.path.join(self.out, name)) as f:
            return json.load(f)

    def strain(self):
        with netCDF4.Dataset(os.path.join(self.out, "simulate.nc")) as f:
            return np.asarray(f["strain"][:], dtype=float)


def setting(pairs):
    return [x for key, value in pairs for x in ("--set", f"{key}={value}")]


def change(strain, base):
    """Mean over the gauges and worst, in percent."""
    relative = np.linalg.norm(strain - base, axis=-1) / np.linalg.norm(base, axis=-1)
    return 100 * relative.mean(), 100 * relative.max()


def row(args, name, pairs, base):
    """Floor, change against `base` and processor time of one setting."""
    alone = [("floor.single_runs", 0), ("floor.finer_mesh", "false"), ("floor.precisions", "false")]
    floor = Measured(args, f"floor_{name}", ["check", "--floor"] + setting(pairs + alone)).json("floor.json")
    mean = Measured(args, f"mean_{name}", ["simulate", "--mean"] + setting(pairs))
    strain = mean.strain()
    if base is None:
        base = strain
    return strain, (100 * floor["mean"], 100 * floor["worst"], *change(strain, base), mean.usage["processor_s"])


def table(args):
    resolved = subprocess.run([os.path.join(args.build, "apps", "calomel"), "check", args.case, "--resolved"] + setting(o.split("=", 1) for o in args.overrides),
                              capture_output=True, text=True, check=True)
    mercury = json.loads(resolved.stdout)["material"]["mercury"]
    keys = ("regularising_viscosity", "least_mesh_viscosity")
    viscosity = lambda f: [(f"material.mercury.{k}", repr(f * mercury[k])) for k in keys]
    base, own = row(args, "default", [("campaign.pulses", 8)], None)
    print("| | floor, mean over gauges [%] | worst gauge [%] | change against the default, mean [%] | worst gauge [%] | processor time of one mean [s] |\n|---|---|---|---|---|---|")
    line = lambda title, numbers: print(f"| {title} | " + " | ".join(f"{x:.3g}" for x in numbers) + " |", flush=True)
    for f in map(float, args.factors.split(",")):
        line(f"viscosity {f:g}", own if f == 1 else row(args, f"viscosity_{f:g}", [("campaign.pulses", 8)] + viscosity(f), base)[1])
    for m in map(int, args.pulses.split(",")):
        line(f"{m} pulse" + "s" * (m > 1), own if m == 8 else row(args, f"pulses_{m}", [("campaign.pulses", m)], base)[1])


def precision(args):
    print("| | single against double, mean over gauges [%] | worst gauge [%] | processor time single / double |\n|---|---|---|---|")
    for title, name, words in (("one run", "one", ["simulate"]), ("mean of 8", "mean", ["simulate", "--mean"])):
        runs = [Measured(args, f"precision_{name}_{p}", words + setting([("solver.precision", p), ("solver.energy_balance", "false")])) for p in ("single", "double")]
        a, b = change(runs[0].strain(), runs[1].strain())
        print(f"| {title} | {a:.3g} | {b:.3g} | {runs[0].usage['processor_s'] / runs[1].usage['processor_s']:.2f} |", flush=True)


def memory(args):
    print("| elements | precision | greatest resident size [MB] | by element [B] |\n|---|---|---|---|")
    for h in args.memory.split(","):
        for p in ("single", "double"):
            run = Measured(args, f"memory_{h}_{p}", ["simulate"] + setting([("geometry.element_size", h), ("solver.precision", p), ("time.end", "1e-6"), ("time.output_interval", "1e-6")]))
            elements, size = run.json("simulate.json")["elements"], run.usage["resident_bytes"]
            print(f"| {elements} | {p} | {size / 1e6:.0f} | {size / elements:.0f} |", flush=True)


if __name__ == "__main__":
    given = arguments()
    os.makedirs(given.work, exist_ok=True)
    precision(given) if given.precision else memory(given) if given.memory else table(given)
