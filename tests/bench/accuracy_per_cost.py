#!/usr/bin/env python3
"""What accuracy costs: error of the ensemble mean against element-steps. Needs Debian's python3-numpy, python3-netcdf4, for the picture python3-matplotlib.

  accuracy_per_cost.py measure BUILD_DIR WORK_DIR NAME CASE.toml|DRAW [--sizes 3,2,1,0.5] [--finer 0.4,0.3] [--reference 0.25] [--variants 'before;default'] [--early MICROSECONDS] [--threads N]
  accuracy_per_cost.py picture WORK_DIR PICTURE.png NAME...

CASE.toml is run at its own parameters, records left out; DRAW is a slice of concealed_slices.py at its true ones. Everything is known, the viscosity is 2000 Pa s on every mesh. Error: relative L2 to
the reference mean, decimated to 20 kHz by a Hann window as the posterior compares, mean over the gauges. The reference is the default at the element size --reference [mm], for every variant. Element-steps: of one
run, `element_steps` of simulate.json. The last column is where a variant comes within 5 % over the whole record, by interpolation of the logarithms; sizes of --finer are run where
those of --sizes do not do. A call that is cut off goes on where it stopped.
"""
import argparse
import json
import os
import re

import numpy as np

from mesh_error import FACTOR, decimated, misfit, simulated, truth_of

OLD = ["material.mercury.hourglass=0.005", "material.mercury.collapse_viscosity=0"]
VARIANTS = {
    "before": ['geometry.wetted="no_separation"'] + OLD,
    "shared nodes": ['geometry.wetted="tied"'] + OLD,
    "parting": OLD,
    "weak hourglass": ["material.mercury.collapse_viscosity=0"],
    "default": [],
    "collapse 0.25": ["material.mercury.collapse_viscosity=0.25"],
    "collapse 1": ["material.mercury.collapse_viscosity=1"],
    "sub-cycles": ["solver.subcycles=3"],
    "4 in the walls": ["geometry.wall_elements=4"],
    "4 in the walls, sub-cycles": ["geometry.wall_elements=4", "solver.subcycles=6"],
    "8 in the walls": ["geometry.wall_elements=8"],
    "hourglass 0.02": ["material.mercury.hourglass=0.02"],
    "steps of 0.3": ["solver.time_step_safety=0.3"],
    "quadratic viscosity": ["material.mercury.quadratic_viscosity=1.5"],
}
STYLE = {"before": "s-", "shared nodes": "^-", "parting": "v-", "weak hourglass": ">-", "default": "o-", "sub-cycles": "D-"}
VISCOSITY = {"material.mercury.least_mesh_viscosity": 0.0, "material.mercury.regularising_viscosity": 2000.0}


def at_five_per_cent(points):
    """(element-steps, mm), or None where the errors do not lie about 5 %."""
    for coarse, fine in zip(points, points[1:]):
        if coarse["all"] >= 5 > fine["all"]:
            share = np.log(coarse["all"] / 5) / np.log(coarse["all"] / fine["all"])
            return tuple(coarse[k] * (fine[k] / coarse[k]) ** share for k in ("element_steps", "mm"))
    return None


def measure(args):
    folder = os.path.join(os.path.abspath(args.work), args.name)
    os.makedirs(folder, exist_ok=True)
    program = os.path.join(os.path.abspath(args.build), "apps", "calomel")
    case, numbers = truth_of(args.case, folder)
    sets = [f"{k}={v!r}" for k, v in (numbers | VISCOSITY).items()]

    def mean(variant, size):
        out = os.path.join(folder, re.sub(r"\W+", "_", variant) + f"_{size:g}")
        strain, numbers = simulated(program, case, out, sets + VARIANTS[variant] + [f"geometry.element_size={1e-3 * size!r}"], args.threads)
        return decimated(strain), numbers

    reference, _ = mean("default", args.reference)
    early = max(1, int(args.early / FACTOR))
    print(f"{args.name}: reference {args.reference:g} mm, first {args.early:g} us apart\n\n| variant | " + " | ".join(f"{s:g} mm" for s in args.sizes) + " | element-steps to 5 % | against before |\n" + "|---" * (len(args.sizes) + 3) + "|")
    result, before = {}, None
    for variant in args.variants:
        points = []
        for size in args.sizes + args.finer:
            if size in args.finer and points[-1]["all"] < 5:
                break
            m, numbers = mean(variant, size)
            points.append({"mm": size, "element_steps": numbers["element_steps"], "all": misfit(m, reference), "early": misfit(m[:, :early], reference[:, :early]), "late": misfit(m[:, early:], reference[:, early:])})
        result[variant], five = points, at_five_per_cent(points)
        before = five if variant == "before" else before
        cells = [f"{p['all']:.1f} ({p['early']:.1f}, {p['late']:.1f})" for p in points[:len(args.sizes)]]
        last = [f"{five[0] / 1e6:.2f} M ({five[1]:.2f} mm)", f"1/{before[0] / five[0]:.1f}" if before else ""] if five else ["", ""]
        print(f"| {variant} | " + " | ".join(cells + last) + " |", flush=True)
    with open(os.path.join(folder, "points.json"), "w") as f:
        json.dump(result, f, indent=1)


def picture(args):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, len(args.names), figsize=(4.4 * len(args.names), 8.2), sharey="row", squeeze=False)
    colours, lines = dict(zip(VARIANTS, plt.get_cmap("tab20").colors[::2] + plt.get_cmap("tab20").colors[1::2])), {}
    for column, name in enumerate(args.names):
        with open(os.path.join(args.work, name, "points.json")) as f:
            result = json.load(f)
        for row, (part, words) in enumerate((("early", "first 100 µs"), ("all", "whole record"))):
            ax = axes[row][column]
            for variant, points in result.items():
                lines[variant], = ax.loglog([p["element_steps"] for p in points], [p[part] for p in points], STYLE.get(variant, "x:"), ms=4, lw=1.8 if variant in STYLE else 0.9,
                                            color=colours[variant])
            ax.axhline(5, color="0.5", lw=0.8)
            ax.set_title(f"{name}, {words}", fontsize=10)
            ax.grid(True, which="both", alpha=0.25)
            ax.set_yticks([0.5, 1, 2, 5, 10, 20, 50], ["0.5", "1", "2", "5", "10", "20", "50"])
            if row == 1:
                ax.set_xlabel("element-steps of one run")
            if column == 0:
                ax.set_ylabel("error of the mean [%]")
    figure.legend([lines[v] for v in VARIANTS if v in lines], [v for v in VARIANTS if v in lines], loc="lower center", ncol=5, fontsize=9, frameon=False)
    figure.tight_layout(rect=(0, 0.08, 1, 1))
    figure.savefig(args.picture, dpi=110)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = p.add_subparsers(required=True)
    m = verbs.add_parser("measure")
    for n in ("build", "work", "name", "case"):
        m.add_argument(n)
    numbers = lambda s: [float(x) for x in s.split(",")]
    m.add_argument("--sizes", default=[3, 2, 1, 0.5], type=numbers)
    m.add_argument("--finer", default=[0.4, 0.3], type=numbers)
    m.add_argument("--reference", default=0.25, type=float)
    m.add_argument("--variants", default=list(VARIANTS), type=lambda s: s.split(";"))
    m.add_argument("--early", default=100, type=float)
    m.add_argument("--threads", type=int, default=2)
    m.set_defaults(do=measure)
    d = verbs.add_parser("picture")
    d.add_argument("work"), d.add_argument("picture"), d.add_argument("names", nargs="+")
    d.set_defaults(do=picture)
    args = p.parse_args()
    args.do(args)


if __name__ == "__main__":
    main()
