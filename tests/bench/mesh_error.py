#!/usr/bin/env python3
"""How far the ensemble mean lies from that of a fine mesh, and what a fit would take it for. Needs Debian's python3-numpy and python3-netcdf4.

  mesh_error.py BUILD_DIR WORK_DIR --targets 401,402,CASE.toml [--sizes 2,1,0.5,0.25] [--wetted slip,no_separation] [--threads N]

A number is a slice of concealed_slices.py at its true parameters, a case file is run at its own, with 2000 Pa s; nothing is recorded or fitted. For every kind of wetted face and element size [mm] the table gives the misfit to
the finest mesh (relative L2 of all gauges, decimated by a Hann window to 20 kHz, as the posterior compares), and what least squares with central differences on the next
finest mesh takes it for: relative changes of density, sound speed, cutoff (logarithm), Young's modulus, pulse energy and viscosity (logarithm), the last three with the priors of
`[errors]` (1.5 %, 1.5 %, 0.6). Means over the targets, ± their standard error. Last, target by target with density, sound speed and cutoff alone free, and the multiple k of the last
difference that the finest mesh lies beyond the one before, and how the last two differences are correlated: along a record before the filter, and between gauges behind it. A call that is cut off goes on where it stopped.
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tomllib

import netCDF4
import numpy as np

from concealed_slices import draw_slice

STEPS = {"material.mercury.density": 1.03, "material.mercury.sound_speed": 1.03, "material.mercury.tensile_cutoff": 1.15, "material.steel.young": 1.03,
         "load.peak_pressure": 1.03, "material.mercury.regularising_viscosity": 1.5}
PRIOR_SD = np.array([1, 1, 1, 0.015, 0.015, 0.6])
FACTOR = 25  # samples of 1 us in a decimated value


def truth_of(target, folder):
    """The case without records and parameters, and the true numbers of its keys."""
    if os.path.exists(target):
        with open(target) as f:
            text = re.sub(r"(?m)^\[recordings\][^\[]*", "", f.read())
        path = os.path.join(folder, "case.toml")
        with open(path, "w") as f:
            f.write(text)
        case = tomllib.loads(text)
        numbers = {k: case[k.split(".")[0]] for k in STEPS if not k.endswith("viscosity")}
        for k in numbers:
            for part in k.split(".")[1:]:
                numbers[k] = numbers[k][part]
        return path, numbers | {"material.mercury.regularising_viscosity": 2000.0, "material.mercury.least_mesh_viscosity": 0.0}
    draw = int(target)
    case, truth, _ = draw_slice(draw, 0.25e-3)
    path = os.path.join(folder, "case.toml")
    with open(path, "w") as f:
        f.write(re.sub(r"\[recordings\][\s\S]*", "", case))
    t = tomllib.loads(truth)
    numbers = {"material.mercury." + n: v for n, v in t["parameter"].items()}
    return path, numbers | {k: float(v) for k, v in (s.split("=") for s in t["experiment"]["unlike"])}


def decimated(strain):
    """(sensors, values) by a Hann window to 20 kHz."""
    window = np.cos(np.pi * np.arange(1 - FACTOR, FACTOR) / (2 * FACTOR)) ** 2
    return np.stack([strain[:, k - FACTOR + 1:k + FACTOR] @ (window / window.sum()) for k in range(FACTOR, strain.shape[1] - FACTOR + 1, FACTOR)], 1)


def simulated(program, case, out, keys, threads):
    """Ensemble mean, (sensors, samples), of the case with these keys, and simulate.json; what is there is not run again."""
    if not os.path.exists(os.path.join(out, "simulate.json")):
        command = [program, "simulate", case, "--mean", "--quiet", "--out", out, "--threads", str(threads)]
        done = subprocess.run(command + [x for k in keys for x in ("--set", k)], capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stderr)
    with netCDF4.Dataset(os.path.join(out, "simulate.nc")) as file, open(os.path.join(out, "simulate.json")) as numbers:
        return np.array(file["strain"][:]), json.load(numbers)


def misfit(coarse, fine):
    """Relative L2 [%], mean over the gauges."""
    return 100 * np.mean(np.linalg.norm(coarse - fine, axis=1) / np.linalg.norm(fine, axis=1))


class Runs:
    def __init__(self, build, folder, target, wetted, threads):
        self.program, self.threads, self.wetted = os.path.join(build, "apps", "calomel"), threads, wetted
        self.name = os.path.basename(os.path.dirname(os.path.abspath(target))) if os.path.exists(target) else f"slice {target}"
        self.folder = os.path.join(folder, f"{self.name}_{wetted}".replace(" ", "_"))
        os.makedirs(self.folder, exist_ok=True)
        self.case, self.truth = truth_of(target, self.folder)

    def samples(self, size, key=None, sign=0):
        """Ensemble mean, (sensors, samples); with `key`, one step up or down."""
        out = os.path.join(self.folder, f"{size}_{key}_{sign}" if key else str(size))
        numbers = dict(self.truth)
        if key:
            numbers[key] *= STEPS[key] ** sign
        keys = [f"{k}={v!r}" for k, v in numbers.items()] + [f"geometry.element_size={1e-3 * size!r}", f'geometry.wetted="{self.wetted}"']
        return simulated(self.program, self.case, out, keys, self.threads)[0]

    def mean(self, size, key=None, sign=0):
        """The same, decimated, (sensors, values)."""
        return decimated(self.samples(size, key, sign))

    def jacobian(self, size):
        return [(self.mean(size, k, 1) - self.mean(size, k, -1)) / (2 * np.log(s)) for k, s in STEPS.items()]


def local_amplitude(values):
    """Root mean square over 25 us about each value."""
    t = FACTOR * np.arange(values.shape[1])
    weight = np.exp(-0.5 * ((t[:, None] - t) / 25) ** 2)
    return np.sqrt(values**2 @ (weight / weight.sum(1, keepdims=True)).T)


def taken_for(fine, coarse, jacobian, priors=True):
    """Least squares: half the local misfit, 2 % of the local amplitude and 0.3 % of the gauge's greatest value as errors."""
    sd = np.sqrt((0.5 * local_amplitude(fine - coarse)) ** 2 + (0.02 * local_amplitude(fine)) ** 2 + (0.003 * np.abs(fine).max(1, keepdims=True)) ** 2)
    if not priors:  # density, sound speed and cutoff alone
        return np.linalg.lstsq(np.stack([(j / sd).ravel() for j in jacobian[:3]], 1), ((fine - coarse) / sd).ravel(), rcond=None)[0]
    a = np.vstack([np.stack([(j / sd).ravel() for j in jacobian], 1), np.diag(1 / PRIOR_SD)])
    return np.linalg.lstsq(a, np.concatenate([((fine - coarse) / sd).ravel(), np.zeros(len(PRIOR_SD))]), rcond=None)[0]


def along_a_record(difference):
    """Correlation over 1, 2, 3, 5, 10 and 20 samples, mean over the gauges."""
    return [np.mean([e[:-lag] @ e[lag:] / (e @ e) for e in difference]) for lag in (1, 2, 3, 5, 10, 20)]


def between_gauges(runs_and_differences):
    """Correlation of decimated differences, means over pairs of gauges by what they lie on and how far apart [mm]."""
    pairs = {}
    for runs, difference in runs_and_differences:
        with open(runs.case, "rb") as f:
            sensors = tomllib.load(f)["sensor"]
        values = decimated(difference)
        for i, a in enumerate(sensors):
            for j, b in enumerate(sensors[:i]):
                apart = np.subtract(a["position"], b["position"])
                same = a["direction"] == b["direction"] and abs(apart[2]) < 1e-9
                far = 1e3 * np.linalg.norm(apart)
                where = f"one wall, {20 * int(far / 20)} to {20 * int(far / 20) + 20} mm" if same else "across, within 12 mm along" if a["direction"] == b["direction"] and abs(apart[0]) < 0.012 else "elsewhere"
                pairs.setdefault(where, []).append(values[i] @ values[j] / np.sqrt((values[i] @ values[i]) * (values[j] @ values[j])))
    return ", ".join(f"{k} {np.mean(v):+.2f} ({len(v)})" for k, v in sorted(pairs.items()))


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("places", nargs=2, metavar=("BUILD_DIR", "WORK_DIR"))
    p.add_argument("--targets", required=True, type=lambda s: s.split(","))
    p.add_argument("--sizes", default=[2, 1, 0.5, 0.25], type=lambda s: [float(x) for x in s.split(",")])
    p.add_argument("--wetted", default=["slip", "no_separation"], type=lambda s: s.split(","))
    p.add_argument("--threads", type=int, default=2)
    args = p.parse_args()
    build, work = (os.path.abspath(x) for x in args.places)
    print("| wetted | mm | misfit | ρ | c | ln σc | E | energy | ln η |\n|---|---|---|---|---|---|---|---|---|")
    lines, alone = [], ["| wetted | target | mm | misfit, mean over gauges | ρ | c | ρc | ln σc |\n|---|---|---|---|---|---|---|---|"]
    for wetted in args.wetted:
        all_runs = [Runs(build, work, target, wetted, args.threads) for target in args.targets]
        means = [{s: runs.mean(s) for s in args.sizes} for runs in all_runs]
        jacobians = [runs.jacobian(args.sizes[-2]) for runs in all_runs]
        for size in args.sizes[:-1]:
            rows = []
            for m, j in zip(means, jacobians):
                fine, coarse = m[args.sizes[-1]], m[size]
                rows.append(100 * np.concatenate([[np.linalg.norm(fine - coarse) / np.linalg.norm(fine)], taken_for(fine, coarse, j)]))
            mean, error = np.mean(rows, 0), np.std(rows, 0, ddof=1) / np.sqrt(len(rows)) if len(rows) > 1 else np.zeros(len(rows[0]))
            print(f"| {wetted} | {size:g} | " + " | ".join(f"{x:+.1f} ± {e:.1f}" if i else f"{x:.1f} ± {e:.1f} %" for i, (x, e) in enumerate(zip(mean, error))) + " |", flush=True)
            for runs, m, j in zip(all_runs, means, jacobians):
                rho, c, cutoff = 100 * taken_for(m[args.sizes[-1]], m[size], j, priors=False)
                alone.append(f"| {wetted} | {runs.name} | {size:g} | {misfit(m[size], m[args.sizes[-1]]):.1f} % | {rho:+.1f} | {c:+.1f} | {rho + c:+.1f} | {cutoff:+.1f} |")
        k, share, size = [], [], []
        for m in means:
            rest, last = (m[args.sizes[-1]] - m[args.sizes[-2]]).ravel(), (m[args.sizes[-2]] - m[args.sizes[-3]]).ravel()
            k.append(rest @ last / (last @ last)), share.append(rest @ last / np.sqrt((last @ last) * (rest @ rest))), size.append(np.linalg.norm(rest) / np.linalg.norm(last))
        lines.append(f"{wetted}: k {', '.join(f'{x:.2f}' for x in k)}: {np.mean(k):.2f} ± {np.std(k):.2f} (sd over targets), correlation {np.mean(share):.2f}, size of the rest over the last difference {np.mean(size):.2f}")
        for coarse, fine in zip(args.sizes[-3:-1], args.sizes[-2:]):
            differences = [runs.samples(fine) - runs.samples(coarse) for runs in all_runs]
            lines.append(f"{wetted}: {coarse:g} less {fine:g} mm, correlation over 1, 2, 3, 5, 10, 20 samples: {', '.join(f'{x:.2f}' for x in np.mean([along_a_record(d) for d in differences], 0))}; between gauges: {between_gauges(zip(all_runs, differences))}")
    print("\n" + "\n".join(alone) + "\n\n" + "\n".join(lines))


if __name__ == "__main__":
    main()
