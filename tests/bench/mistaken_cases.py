#!/usr/bin/env python3
"""Posteriors of cases that are wrong in one way: does `calomel sample` say so, and how far off is its answer? Needs Python 3 alone.

  mistaken_cases.py run   CALOMEL SUITE WORK_DIR --cases case_144 [--ways late,gain] [--threads T] [--set table.key=value]...
  mistaken_cases.py table SUITE WORK_DIR

SUITE is a suite of `calomel challenge` whose cases are made, WORK_DIR/CASE_WAY what is made of a case. Of each case that is named one number of the case file or of its records is wrong in one way after the other, as by a slip
of the hand; the posterior is sampled on meshes of 2 and 1 mm. `table` has a line a way of each case: how far the parameters lie from the truth in the deviations result, chi-squared, and what is warned of, the mesh apart. What is
sampled already is not sampled again.
"""
import json
import os
import re

from coverage_of_posterior import truth_of
from spoilt_records import GAUGE, late, main, of_gauge, read, run_case, scaled, write

SET = ('solver.precision="single"', "emulator.element_sizes=[2e-3,1e-3]", 'emulator.start="nominal"')


def by_sample(change):
    """The records with those of GAUGE changed by change(value, greatest, share of the record that has passed)."""

    def changed(series):
        greatest = max(abs(x) for (sensor, _), v in series.items() if sensor == GAUGE for _, x in v)
        return of_gauge(lambda v, r: [(t, change(x, greatest, i / len(v))) for i, (t, x) in enumerate(v)])(series)

    return changed


def changed_number(before, change):
    """The case with change(number) in place of the number behind this pattern."""
    return lambda case: re.sub(f"({before})" + r"([\d.e+-]+)", lambda m: m[1] + f"{change(float(m[2])):.6g}", case, count=1)


def higher(case):
    """The target and its upper gauges 1 mm higher."""
    height = re.search(r"(?m)^height = (\S+)", case).group(1)
    return case.replace(f"height = {height}", f"height = {float(height) + 1e-3:g}").replace(f"0.0, {height}]", f"0.0, {float(height) + 1e-3:g}]")


def same(x):
    return x


WAYS = {  # name: (what is wrong, of the case, of the records)
    "as_it_is": ("nothing", same, same),
    "late": ("records 1.5 µs late", same, lambda s: {k: late(v, 1.5e-6) for k, v in s.items()}),
    "pulse": ("pulse length 1.4 times its value", changed_number("pulse_length = ", lambda x: 1.4 * x), same),
    "pressure": ("heating pressure 5 % low", changed_number("peak_pressure = ", lambda x: 0.95 * x), same),
    "width": ("beam 10 % wider", changed_number(r"widths = \[[\d.e+]+, ", lambda x: 1.1 * x), same),
    "wall": ("front wall 1 mm thinner", changed_number("front = ", lambda x: x - 1e-3), same),
    "height": ("target 1 mm higher", higher, same),
    "gains": ("all gains 10 % high", same, lambda s: {k: [(t, 1.1 * x) for t, x in v] for k, v in s.items()}),
    "gain": (f"gain of {GAUGE} 15 % high", same, scaled(1.15)),
    "place": (f"{GAUGE} 5 mm from its place", changed_number(f'name = "{GAUGE}"\nposition = \\[', lambda x: x + 5e-3), same),
    "clipped": (f"{GAUGE} clipped at 80 % of its greatest strain", same, by_sample(lambda x, greatest, share: max(-0.8 * greatest, min(0.8 * greatest, x)))),
    "drift": (f"{GAUGE} drifts by half of its greatest strain", same, by_sample(lambda x, greatest, share: x + 0.5 * greatest * share)),
    "dead": (f"{GAUGE} dead", same, by_sample(lambda x, greatest, share: 0.0)),
    "sign": (f"{GAUGE} of the other sign", same, scaled(-1.0)),
}


def run(args):
    for case in args.cases:
        source = os.path.join(args.suite, "cases", case)
        with open(os.path.join(source, "case.toml"), encoding="utf-8") as f:
            text = f.read()
        series = read(os.path.join(source, "recordings.csv"))
        for way in args.ways or WAYS:
            place = os.path.join(args.work, f"{case}_{way}")
            if os.path.exists(os.path.join(place, "out", "posterior.json")):
                continue
            _, of_case, of_records = WAYS[way]
            os.makedirs(place, exist_ok=True)
            with open(os.path.join(place, "case.toml"), "w", encoding="utf-8") as f:
                f.write(of_case(text))
            write(os.path.join(place, "recordings.csv"), of_records(series))
            run_case(args, "sample", place, SET)


def short(sentence):
    """The finding of a sentence, without its explanation."""
    sentence = re.sub(r"the records shift (.*) by (\S+) of its prior standard deviations.*", r"\1 \2 sd", sentence)
    sentence = re.sub(r"(\S+) is (\S+) prior standard deviations (above|below).*", lambda m: f"{m[1]} {'-' if m[3] == 'below' else '+'}{m[2]} sd", sentence)
    return re.sub(r" \((log Bayes factor|correlation).*", "", sentence).split(":")[0]


def table(args):
    names = ("tensile_cutoff", "density", "sound_speed")
    print("| wrong | " + " | ".join(n.replace("_", " ") for n in names) + " | chi-squared | warnings |\n|---|" + "---|" * (len(names) + 2))
    cases = sorted({name[: -len(way) - 1] for name in os.listdir(args.work) for way in WAYS if name.endswith("_" + way)})
    for case in cases:
        truth = truth_of(args.suite, case)
        for way, (wrong, _, _) in WAYS.items():
            try:
                with open(os.path.join(args.work, f"{case}_{way}", "out", "posterior.json"), encoding="utf-8") as f:
                    result = json.load(f)
            except FileNotFoundError:
                continue
            found = {p["name"]: p for p in result["parameters"]}
            off = [f"{(found[n]['mean'] - truth[n]) / found[n]['sd']:+.1f}" for n in names]
            chi2, values = re.search(r"chi-squared (\S+) for (\d+) values", result["adequacy"]).groups()
            said = [w for w in result["warnings"] if "elements through the front" not in w] + result["absorption"] + ([] if result["converged"] else [result["message"]])
            print(f"| {wrong} | " + " | ".join(off) + f" | {float(chi2):.0f} of {values} | {'; '.join(map(short, said)) or 'nothing'} |")


if __name__ == "__main__":
    main(__doc__, WAYS, run, table)
