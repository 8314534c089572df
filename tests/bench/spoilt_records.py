#!/usr/bin/env python3
"""Diagnoses of records that are worse than those of `calomel challenge`. Needs Python 3 alone.

  spoilt_records.py run   CALOMEL SUITE WORK_DIR --cases case_003,case_011 [--ways two_pulses,hum] [--threads T] [--set table.key=value]...
  spoilt_records.py table SUITE WORK_DIR

SUITE is a suite of `calomel challenge` whose cases are made. Of each case that is named, the records are spoilt in one way after the other and diagnosed anew: one pulse or two, few gauges, coarse samples, gaps, noise of
other kinds (white, slow, a tone, spikes, a burst that the beam makes in the cables, clocks that jitter), one gauge grossly at fault. `table` has a line a way and a column a case; the first line is the case as it is. What is diagnosed already is not diagnosed
again.
"""
import argparse
import csv
import json
import math
import os
import random
import re
import subprocess
import sys

STEP = 1e-6  # of a suite's records [s]
GAUGE = "T2"  # of those at fault


def read(path):
    """{(sensor, pulse): [(time, strain)]}, in the file's order."""
    series = {}
    with open(path) as f:
        rows = csv.reader(f)
        next(rows)
        for sensor, pulse, time, strain in rows:
            series.setdefault((sensor, int(pulse)), []).append((float(time), float(strain)))
    return series


def write(path, series):
    with open(path, "w") as f:
        f.write("sensor,pulse,time,strain\n")
        f.writelines(f"{sensor},{pulse},{t:.6e},{x:.6e}\n" for (sensor, pulse), v in series.items() for t, x in v)


def run_case(args, verb, place, settings=()):
    """calomel VERB of place/case.toml into place/out, its output in place/log; an exit status other than 0 and 4 is printed."""
    command = [args.calomel, verb, os.path.join(place, "case.toml"), "--out", os.path.join(place, "out"), "--threads", str(args.threads)]
    with open(os.path.join(place, "log"), "w") as log:
        status = subprocess.run([*command, *[x for s in (*settings, *args.set) for x in ("--set", s)]], stdout=log, stderr=log).returncode
    if status not in (0, 4):
        print(f"{place}: exit status {status}", file=sys.stderr)


def add(series, noise):
    """noise(samples) of every series on its own."""
    return {k: [(t, x + n) for (t, x), n in zip(v, noise(v))] for k, v in series.items()}


def slow(r, n, sd, time):
    """First-order autoregressive noise of this correlation time [s]."""
    keep, x, out = math.exp(-STEP / time), r.gauss(0, sd), []
    for _ in range(n):
        out.append(x)
        x = keep * x + math.sqrt(1 - keep * keep) * r.gauss(0, sd)
    return out


def low_passed(v, every, half=4):
    """Every so many samples of a series after a Hann window of 2 half + 1 samples."""
    w = [0.5 * (1 + math.cos(math.pi * k / (half + 1))) for k in range(-half, half + 1)]
    at = lambda i: v[min(max(i, 0), len(v) - 1)][1]
    return [(v[i][0], sum(a * at(i + k - half) for k, a in enumerate(w)) / sum(w)) for i in range(0, len(v), every)]


def late(v, delay):
    """A series as a clock shows it that is late by so much [s]."""
    out = []
    for i, (t, _) in enumerate(v):
        u = i - delay / STEP
        j = min(max(int(math.floor(u)), 0), len(v) - 2)
        out.append((t, v[j][1] + (u - j) * (v[j + 1][1] - v[j][1])))
    return out


def one_of_each_face(series):
    """Three gauges: the second of the top and of the bottom, and the front's."""
    return {k: v for k, v in series.items() if k[0] in ("T2", "B2", "F1")}


def of_gauge(change):
    """The records with every series of GAUGE changed by change([(time, strain)], random stream)."""
    return lambda series, r=None: {k: change(v, r) if k[0] == GAUGE else v for k, v in series.items()}


def scaled(factor):
    return of_gauge(lambda v, r: [(t, factor * x) for t, x in v])


def with_jitter(series, r):
    delays = {pulse: r.gauss(0, 0.5e-6) for pulse in sorted({k[1] for k in series})}
    return {k: late(v, delays[k[1]]) for k, v in series.items()}


def ways(peak):
    """Name: (what is done, the function that does it)."""
    tone = lambda r, v, phase: [6e-6 * math.sin(2 * math.pi * 12e3 * t + phase) for t, _ in v]
    return {
        "as_it_is": ("as it is", lambda s, r: s),
        "one_pulse": ("one pulse, its noise as it is without the pulse", lambda s, r: {k: v for k, v in s.items() if k[1] == 0}),
        "two_pulses": ("two pulses", lambda s, r: {k: v for k, v in s.items() if k[1] < 2}),
        "three_gauges": ("three gauges, one a face", lambda s, r: one_of_each_face(s)),
        "coarse": ("every fourth sample, after a low pass", lambda s, r: {k: low_passed(v, 4) for k, v in s.items()}),
        "aliased": ("every fourth sample, without one", lambda s, r: {k: v[::4] for k, v in s.items()}),
        "gaps": ("every tenth sample missing, one gauge ends early", lambda s, r: {k: [x for x in v if r.random() > 0.1 and not (k[0] == "T3" and x[0] > 1.5e-4)] for k, v in s.items()}),
        "pretrigger": ("30 µs before the pulse", lambda s, r: {k: [(STEP * i, r.gauss(0, 3e-6)) for i in range(-30, 0)] + v for k, v in s.items()}),
        "white": ("white noise, 15 microstrain", lambda s, r: add(s, lambda v: [r.gauss(0, 15e-6) for _ in v])),
        "slow": ("slow noise, 8 microstrain, 30 µs", lambda s, r: add(s, lambda v: slow(r, len(v), 8e-6, 30e-6))),
        "tone": ("a tone of 12 kHz, 6 microstrain, its phase random", lambda s, r: add(s, lambda v: tone(r, v, r.uniform(0, 2 * math.pi)))),
        "spikes": ("3 in 1000 samples off by the greatest strain", lambda s, r: add(s, lambda v: [r.choice((-1, 1)) * peak if r.random() < 0.003 else 0 for _ in v])),
        "burst": ("a burst of 5 µs as large as the greatest strain", lambda s, r: add(s, lambda v: [peak * math.exp(-t / 1e-6) * r.gauss(0, 1) if t < 5e-6 else 0 for t, _ in v])),
        "half": (f"{GAUGE} reads half", scaled(0.5)),
        "double": (f"{GAUGE} reads twice", scaled(2.0)),
        "reversed": (f"{GAUGE} of the other sign", scaled(-1.0)),
        "dead": (f"{GAUGE} dead, its noise 3 microstrain", of_gauge(lambda v, r: [(t, r.gauss(0, 3e-6)) for t, _ in v])),
        "late": (f"{GAUGE} late by 8 µs", of_gauge(lambda v, r: late(v, 8e-6))),
        "drift": (f"{GAUGE} drifts by half of the greatest strain", of_gauge(lambda v, r: [(t, x + 0.5 * peak * t / v[-1][0]) for t, x in v])),
        "clipped": (f"{GAUGE} clipped at 60 % of the greatest strain of all", of_gauge(lambda v, r: [(t, max(-0.6 * peak, min(0.6 * peak, x))) for t, x in v])),
        "jitter": ("clocks that jitter by 0.5 µs from pulse to pulse", with_jitter),
    }


def text_of(case, sensors):
    """The case with these of its gauges alone."""
    blocks = re.split(r"(?m)^(?=\[)", case)
    named = lambda b: re.search(r'(?m)^name = "(.*?)"', b).group(1)
    return "".join(b for b in blocks if not b.startswith("[[sensor]]") or named(b) in sensors)


def noise_lines(truth):
    """[recordings] of a single pulse: what an engineer reads off the record before the pulse comes."""
    with open(truth) as f:
        text = f.read()
    gauges = re.findall(r"(?ms)^\[nuisance\.gauge\.(\w+)\].*?^noise = (\S+)", text)
    return "noise = { " + ", ".join(f"{g} = {n}" for g, n in gauges) + " }\nnoise_time = " + re.search(r"(?m)^noise_time = (\S+)", text).group(1) + "\n"


def spoil(suite, name, place, way):
    source = os.path.join(suite, "cases", name)
    series = read(os.path.join(source, "recordings.csv"))
    peak = max(abs(x) for v in series.values() for _, x in v)
    spoilt = ways(peak)[way][1](series, random.Random(way))
    os.makedirs(place, exist_ok=True)
    with open(os.path.join(source, "case.toml")) as f:
        case = text_of(f.read(), {sensor for sensor, _ in spoilt})
    if way == "one_pulse":
        case = case.replace('file = "recordings.csv"\n', 'file = "recordings.csv"\n' + noise_lines(os.path.join(suite, "truth", name + ".toml")), 1)
    with open(os.path.join(place, "case.toml"), "w") as f:
        f.write(case)
    write(os.path.join(place, "recordings.csv"), spoilt)


def run(args):
    for way in args.ways or ways(1):
        for case in args.cases:
            place = os.path.join(args.work, f"{case}_{way}")
            if os.path.exists(os.path.join(place, "out", "diagnosis.json")):
                continue
            spoil(args.suite, case, place, way)
            run_case(args, "diagnose", place)


def findings(place):
    try:
        with open(os.path.join(place, "out", "diagnosis.json")) as f:
            d = json.load(f)
    except FileNotFoundError:
        return ""
    best = max((r.get("log_bayes_factor") or 0 for r in d["ranking"]), default=0)
    return f"{' + '.join(d['mechanisms']) or d['verdict']}, chi-squared {d['evidence']['chi2']:.0f} of {d['evidence']['values']:.0f}" + (f", log Bayes factor {best:.0f}" if d["mechanisms"] else "")


def table(args):
    known = ways(1)
    cases = sorted({name[: -len(way) - 1] for name in os.listdir(args.work) for way in known if name.endswith("_" + way)})
    concealed = []
    for case in cases:
        with open(os.path.join(args.suite, "truth", case + ".toml")) as f:
            truth = f.read()
        concealed.append(re.search(r'(?m)^mechanism = "(.*?)"', truth).group(1) or re.search(r'(?m)^family = "(.*?)"', truth).group(1))
    print("| records | " + " | ".join(f"{c}: {m}" for c, m in zip(cases, concealed)) + " |\n" + "|---" * (len(cases) + 1) + "|")
    for way, (text, _) in known.items():
        row = [findings(os.path.join(args.work, f"{case}_{way}")) for case in cases]
        if any(row):
            print(f"| {text} | " + " | ".join(row) + " |")


def main(doc, ways, run, table):
    """The command line of a bench of cases that are made worse, one way after the other."""
    p = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = p.add_subparsers(dest="verb", required=True)
    one = verbs.add_parser("run")
    for name in ("calomel", "suite", "work"):
        one.add_argument(name)
    one.add_argument("--cases", required=True, type=lambda s: s.split(","))
    one.add_argument("--ways", type=lambda s: s.split(","))
    one.add_argument("--threads", type=int, default=1)
    one.add_argument("--set", action="append", default=[])
    two = verbs.add_parser("table")
    two.add_argument("suite"), two.add_argument("work")
    args = p.parse_args()
    unknown = set(getattr(args, "ways", None) or ()) - set(ways)
    if unknown:
        p.error(f"--ways: {', '.join(sorted(unknown))}; there are {', '.join(ways)}")
    {"run": run, "table": table}[args.verb](args)


if __name__ == "__main__":
    main(__doc__, ways(1), run, table)
