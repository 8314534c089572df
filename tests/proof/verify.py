#!/usr/bin/env python3
"""What the generator's own grid costs, and how far it agrees with the library. Needs Debian's python3-numpy, and python3-netcdf4 for --library.

  verify.py GENERATOR CALOMEL WORK_DIR [--seed 1] [--slices 3] [--grids 0.5,0.25,0.125] [--library --elements 0.5,0.25]

Slices of `calomel challenge make` with nothing concealed, no noise, gauges in their places and gains of 1: ensemble means of eight energies. Relative L2, mean over the gauges (worst), of all samples and after a
Hann window to 20 kHz, as the posterior compares; of every grid against the next finer one, and of the library's `simulate --mean` at the true parameters against the grids. A call that is cut off
goes on where it stopped.
"""
import argparse
import os
import re
import subprocess
import sys
import time
import tomllib

import numpy as np

ENERGIES = [0.97699, 0.98669, 0.99267, 0.99764, 1.00236, 1.00733, 1.01331, 1.02301]  # quantiles of 1.5 %, those of the library
FACTOR = 25  # samples of 1 us in a decimated value


def drawn_specs(program, folder, seed, slices):
    """SPEC files of cases with nothing concealed."""
    out = os.path.join(folder, f"drawn_{seed}_{slices}")
    kinds = [x for kind in ("single", "outside", "sensor", "pair") for x in (f"--{kind}", "0")]
    done = subprocess.run([program, "challenge", "make", "--seed", str(seed), "--out", out, "--none", str(slices), *kinds, "--specs", "--quiet"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    texts = []
    for index in range(slices):
        with open(os.path.join(out, "truth", f"case_{index + 1:03d}.spec.toml")) as f:
            texts.append(f.read())
    return texts


def slice_spec(path, drawn, grid, cutoff=None):
    text = re.sub(r"(?m)^grid = .*$", f"grid = {grid!r}", drawn)
    text = re.sub(r"(?m)^(place_sd|gain_sd|noise) = .*$", r"\1 = 0.0", text)
    text = re.sub(r"\[pulses\]\n(.+\n)+", f"[pulses]\nenergies = {ENERGIES}\n", text)
    if cutoff:
        text = re.sub(r"(?m)^tensile_cutoff = .*$", f"tensile_cutoff = {cutoff}", text)
    with open(path, "w") as f:
        f.write(text)
    return tomllib.loads(text)


def own(generator, folder, spec_path, grid):
    out = os.path.join(folder, f"grid_{grid:g}.csv")
    if not os.path.exists(out):
        start = time.time()
        subprocess.run([generator, spec_path, "--mean", out + ".part"], check=True, capture_output=True)
        os.rename(out + ".part", out)
        print(f"{out}: {time.time() - start:.1f} s", file=sys.stderr, flush=True)
    rows = {}
    with open(out) as f:
        next(f)
        for line in f:
            name, _, value = line.split(",")
            rows.setdefault(name, []).append(float(value))
    return np.array(list(rows.values()))


def library(program, generator, folder, spec_path, truth, size):
    import netCDF4
    case, out = os.path.join(folder, "user"), os.path.join(folder, f"elements_{size:g}")
    if not os.path.exists(case):  # the case as a user would have it; its records are not read
        subprocess.run([generator, spec_path, case, "--truth", os.path.join(folder, "truth.toml")], check=True, capture_output=True)
        path = os.path.join(case, "case.toml")
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(re.sub(r"(?m)^\[recordings\][^\[]*", "", text) + '\n[solver]\nprecision = "single"\n')
    if not os.path.exists(os.path.join(out, "simulate.json")):
        keys = {"geometry.element_size": 1e-3 * size, "material.steel.young": truth["steel"]["young"], "load.pulse_length": truth["load"]["pulse_length"],
                "material.mercury.regularising_viscosity": truth["mercury"]["viscosity"], "material.mercury.least_mesh_viscosity": 0.0}
        keys |= {f"material.mercury.{k}": truth["mercury"][k] for k in ("density", "sound_speed", "tensile_cutoff")}
        command = [program, "simulate", os.path.join(case, "case.toml"), "--mean", "--quiet", "--threads", "1", "--out", out]
        done = subprocess.run(command + [x for k, v in keys.items() for x in ("--set", f"{k}={v!r}")], capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stderr)
    with netCDF4.Dataset(os.path.join(out, "simulate.nc")) as file:
        return np.array(file["strain"][:])


def decimated(strain):
    window = np.cos(np.pi * np.arange(1 - FACTOR, FACTOR) / (2 * FACTOR)) ** 2
    return np.stack([strain[:, k - FACTOR + 1:k + FACTOR] @ (window / window.sum()) for k in range(FACTOR, strain.shape[1] - FACTOR + 1, FACTOR)], 1)


def differences(a, b):
    out = []
    for x, y in ((a, b), (decimated(a), decimated(b))):
        off = 100 * np.linalg.norm(x - y, axis=1) / np.linalg.norm(y, axis=1)
        out += [off.mean(), off.max()]
    return out


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("generator")
    p.add_argument("calomel")
    p.add_argument("work")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--slices", type=int, default=3)
    numbers = lambda s: [float(x) for x in s.split(",")]
    p.add_argument("--grids", type=numbers, default=[0.5, 0.25, 0.125])
    p.add_argument("--library", action="store_true")
    p.add_argument("--elements", type=numbers, default=[0.5, 0.25])
    args = p.parse_args()
    results = {}
    os.makedirs(args.work, exist_ok=True)
    for index, drawn in enumerate(drawn_specs(os.path.abspath(args.calomel), os.path.abspath(args.work), args.seed, args.slices)):
        folder = os.path.join(os.path.abspath(args.work), f"slice_{args.seed}_{index}")
        os.makedirs(folder, exist_ok=True)
        means = {}
        for grid in args.grids:
            path = os.path.join(folder, f"grid_{grid:g}.toml")
            slice_spec(path, drawn, 1e-3 * grid)
            means[f"grid {grid:g}"] = own(os.path.abspath(args.generator), folder, path, grid)
        path = os.path.join(folder, f"grid_{args.grids[0]:g}.toml")  # any grid will do to write the case
        truth = slice_spec(path, drawn, 1e-3 * args.grids[0])
        for size in args.elements if args.library else []:
            means[f"library {size:g}"] = library(os.path.abspath(args.calomel), os.path.abspath(args.generator), folder, path, truth, size)
        grids = [f"grid {g:g}" for g in args.grids]
        pairs = list(zip(grids, grids[1:])) + [(a, b) for a in means if a.startswith("library") for b in grids[-2:]]
        for a, b in pairs:
            results.setdefault((a, b), []).append(differences(means[a], means[b]))
    print("| compared [mm] | all samples | decimated | slice by slice, decimated |\n|---|---|---|---|")
    for (a, b), rows in results.items():
        m = np.array(rows)
        print(f"| {a} with {b} | {m[:, 0].mean():.2f} % ({m[:, 1].max():.1f}) | {m[:, 2].mean():.2f} % ({m[:, 3].max():.1f}) | {', '.join(f'{x:.2f}' for x in m[:, 2])} |")


if __name__ == "__main__":
    main()
