#!/usr/bin/env python3
"""Posteriors of box slices whose target and parameters are drawn at random and concealed. Needs Python 3 alone.

  concealed_slices.py record    BUILD_DIR WORK_DIR --draws 1,2,3 [--element 0.3e-3] [--threads N]
  concealed_slices.py calibrate BUILD_DIR WORK_DIR --draws 1,2,3 --name NAME [--verb "sample" | "calibrate --method map"] [--set table.key=value]... [--threads N]
  concealed_slices.py table     WORK_DIR --draws 1,2,3 --name NAME [--answer posterior|map|enc|spe]

For each draw a target is drawn (length 0.09 to 0.11 m, height 0.032 to 0.038 m, walls 3 to 5 mm, eight gauges, 0.24 ms) with the parameters (density from 12 500 to 14 000,
sound speed from 1380 to 1520, the logarithm of the cutoff from 8e4 to 3e5) and the viscosity of the records (ln normal, 2000 Pa s, 0.6). make_recordings plays the experiment with
elements of `--element`, another time step, a steel whose modulus is 1.5 % (sd) off, an energy of all pulses 1.5 %, gauges 0.3 mm and gains 1 % off, eight pulses of unequal energy and
coloured noise. NAME tells
settings apart; all settings of one draw share the runs of its journal. A call that is cut off goes on where it stopped. `table` gives distances from the truth, in per cent and,
in brackets, in the answer's own standard deviations; the impedance's deviation comes from the covariance of the answer.
"""
import argparse
import json
import math
import os
import random
import statistics
import subprocess
import sys

CASE = """[case]
name = "concealed slice {draw}"
[geometry]
kind = "box"
length = {length:.4f}
width = 0.10
height = {height:.4f}
walls = {{ front = {front:.4f}, rear = 0.005, side = 0.005, top = {top:.4f}, bottom = {bottom:.4f} }}
rear = "non_reflecting"
plane_strain = true
element_size = 0.001
[material.steel]
density = 7960.0
young = 193e9
poisson = 0.29
[material.mercury]
law = "riemer"
density = 13500.0
sound_speed = 1450.0
tensile_cutoff = 1.5e5
[load]
policy = "fixed"
peak_pressure = {peak:.3e}
[load.profile]
center = [0.0, {middle:.4f}]
widths = [1000.0, {width:.4f}]
decay = 0.13
buildup = 1.5
buildup_length = 0.02
exponent = 2.0
[time]
end = 0.24e-3
output_interval = 1e-6
[solver]
precision = "single"
{sensors}[recordings]
file = "records_{draw}.nc"
"""
PARAMETERS = """[parameter.tensile_cutoff]
min = 0.0
max = 1.5e6
nominal = 1.5e5
[parameter.density]
min = {density[0]}
max = {density[1]}
nominal = 13500.0
[parameter.sound_speed]
min = {speed[0]}
max = {speed[1]}
nominal = 1450.0
"""
SENSOR = '[[sensor]]\nname = "{name}"\nposition = [{x:.4f}, 0.0, {z:.4f}]\ndirection = {direction}\ngauge_length = 0.002\n'


def paths(work, draw):
    return tuple(os.path.join(work, f"{what}_{draw}.{end}") for what, end in (("case", "toml"), ("truth", "toml"), ("records", "nc")))


def draw_slice(draw, element):
    """The case, the truth file of make_recordings, and the true parameters."""
    r = random.Random(f"concealed slices {draw}")
    length, height = r.uniform(0.09, 0.11), r.uniform(0.032, 0.038)
    front, top, bottom = (0.001 * r.choice((3, 4, 5)) for _ in range(3))
    sensors = ""
    for i, share in enumerate((0.12, 0.32, 0.52, 0.75)):
        sensors += SENSOR.format(name=f"T{i + 1}", x=length * (share + r.uniform(-0.04, 0.04)), z=height, direction="[1, 0, 0]")
    for i, share in enumerate((0.2, 0.45, 0.7)):
        sensors += SENSOR.format(name=f"L{i + 1}", x=length * (share + r.uniform(-0.04, 0.04)), z=0, direction="[1, 0, 0]")
    sensors += SENSOR.format(name="W", x=0, z=height * r.uniform(0.45, 0.65), direction="[0, 0, 1]")
    peak = r.uniform(20e6, 30e6)
    case = CASE.format(draw=draw, length=length, height=height, front=front, top=top, bottom=bottom, peak=peak, middle=height * r.uniform(0.45, 0.55),
                       width=height * r.uniform(0.28, 0.4), sensors=sensors) + PARAMETERS.format(density=(10000.0, 16000.0), speed=(1000.0, 2000.0))
    truth = {"density": r.uniform(12500, 14000), "sound_speed": r.uniform(1380, 1520), "tensile_cutoff": math.exp(r.uniform(math.log(8e4), math.log(3e5)))}
    truth = {n: float(f"{v:.6g}") for n, v in truth.items()}
    young, viscosity = 193e9 * (1 + 0.015 * r.gauss(0, 1)), 2000 * math.exp(0.6 * r.gauss(0, 1))
    peak *= 1 + 0.015 * r.gauss(0, 1)
    lines = ["[parameter]"] + [f"{n} = {v:.6g}" for n, v in truth.items()]
    lines += ["[experiment]", f"seed = {r.randrange(10**6)}", 'precision = "single"', f"element_size_ratio = {element / 0.001:.4g}", f"time_step_safety = {r.choice((0.7, 0.8, 0.9))}",
              "sample_interval = 1e-6", "energy_sd = 0.015", "noise_time = 5e-6", "resolution = 1e-8", "place_sd = 0.3e-3", "gain_sd = 0.01",
              f'unlike = ["material.steel.young={young:.6g}", "material.mercury.regularising_viscosity={viscosity:.6g}", "material.mercury.least_mesh_viscosity=0", '
              f'"load.peak_pressure={peak:.6g}"]']
    names = [line.split('"')[1] for line in sensors.splitlines() if line.startswith("name")]
    lines += ["[pulses]"] + [f"{s} = 8" for s in names] + ["[noise]"] + [f"{s} = {r.choice((5e-6, 5e-6, 8e-6))}" for s in names]
    return case, "\n".join(lines) + "\n", truth | {"viscosity": viscosity}


def call(command, log):
    """Exit status 4 (not to be trusted) is a result too: the table reports it."""
    with open(log, "a") as f:
        f.write("$ " + " ".join(command) + "\n")
        f.flush()
        status = subprocess.run(command, stdout=f, stderr=f).returncode
    if status not in (0, 4):
        sys.exit(f"{' '.join(command)}: exit status {status}, see {log}")


def record(args):
    for draw in args.draws:
        case, truth, records = paths(args.work, draw)
        if not os.path.exists(records):
            for path, text in zip((case, truth), draw_slice(draw, args.element)):
                with open(path, "w") as f:
                    f.write(text)
            recorder = os.path.join(args.build, "examples", "recorder", "make_recordings")
            call([recorder, case, truth, records + ".part"], os.path.join(args.work, "recordings.log"))
            os.rename(records + ".part", records)


def calibrate(args):
    program = os.path.join(args.build, "apps", "calomel")
    for draw in args.draws:
        out = os.path.join(args.work, f"{draw}_{args.name}")
        runs = os.path.join(args.work, f"runs_{draw}.journal")
        os.makedirs(out, exist_ok=True)
        if not os.path.exists(runs):
            open(runs, "a").close()
            os.remove(runs)
        own = os.path.join(out, "runs.journal")
        if os.path.exists(runs) and not os.path.exists(own):
            os.link(runs, own)  # all settings of one draw share the runs
        verb, *options = args.verb.split()
        call([program, verb, paths(args.work, draw)[0], *options, "--out", out, "--threads", str(args.threads)] + [x for s in args.set for x in ("--set", s)],
             os.path.join(out, "log"))
        if os.path.exists(own) and not os.path.exists(runs):
            os.link(own, runs)


def answer(out, name):
    """Values, covariance and whether it is trusted."""
    with open(os.path.join(out, name + ".json")) as f:
        j = json.load(f)
    if name == "posterior":
        value = {p["name"]: p["mean"] for p in j["parameters"]}
        names, covariance = list(j["mode"]["theta"]), j["mode"]["covariance"]
        sd = {p["name"]: p["sd"] for p in j["parameters"]}
        passes = j["converged"]
    else:
        value = j["theta"]
        names, covariance = j.get("parameters", []), j.get("covariance", [])
        sd = {n: math.sqrt(covariance[i][i]) for i, n in enumerate(names)}
        passes = j["status"] == "done"
    value["impedance"] = value["density"] * value["sound_speed"]
    if covariance:
        a, b = names.index("density"), names.index("sound_speed")
        relative = covariance[a][a] / value["density"] ** 2 + covariance[b][b] / value["sound_speed"] ** 2 + 2 * covariance[a][b] / value["impedance"]
        sd["impedance"] = value["impedance"] * math.sqrt(max(relative, 0))
    return value, sd, passes, j


def table(args):
    names = ("density", "sound_speed", "impedance", "tensile_cutoff")
    distances, scores = {n: [] for n in names}, {n: [] for n in names}
    print("| draw | density | sound speed | ρc | ln σc | passes |\n|---|---|---|---|---|---|")
    for draw in args.draws:
        out = os.path.join(args.work, f"{draw}_{args.name}")
        if not os.path.exists(os.path.join(out, args.answer + ".json")):
            continue
        truth = draw_slice(draw, args.element)[2]
        truth["impedance"] = truth["density"] * truth["sound_speed"]
        value, sd, passes, _ = answer(out, args.answer)
        cells = []
        for n in names:
            off = math.log(value[n] / truth[n]) * (1 if n == "tensile_cutoff" else 100)
            distances[n].append(off)
            cells.append(f"{off:+.3f}" if n == "tensile_cutoff" else f"{off:+.1f} %")
            if n in sd:  # a point calibration has none
                dev = sd[n] / value[n] * (1 if n == "tensile_cutoff" else 100)
                scores[n].append(off / dev)
                cells[-1] = f"{off:+.3f} ± {dev:.3f} ({off / dev:+.1f})" if n == "tensile_cutoff" else f"{off:+.1f} ± {dev:.1f} % ({off / dev:+.1f})"
        print(f"| {draw} | " + " | ".join(cells) + f" | {'yes' if passes else 'no'} |")
    for n in names:
        d, z = distances[n], scores[n]
        if len(d) > 1:
            rms = math.sqrt(statistics.fmean(x * x for x in d))
            print(f"{n}: rms {rms:.3g}{'' if n == 'tensile_cutoff' else ' %'}, mean {statistics.fmean(d):+.2g}"
                  + (f"; in deviations rms {math.sqrt(statistics.fmean(x * x for x in z)):.2f}, mean {statistics.fmean(z):+.2f} ± {statistics.stdev(z) / math.sqrt(len(z)):.2f}" if len(z) > 1 else ""))


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("what", choices=("record", "calibrate", "table"))
    p.add_argument("places", nargs="+", metavar="BUILD_DIR WORK_DIR")
    p.add_argument("--draws", required=True, type=lambda s: [int(x) for x in s.split(",")])
    p.add_argument("--element", type=float, default=0.3e-3)
    p.add_argument("--name", default="calibration")
    p.add_argument("--verb", default="sample")
    p.add_argument("--answer", default="posterior")
    p.add_argument("--set", action="append", default=[])
    p.add_argument("--threads", type=int, default=2)
    args = p.parse_args()
    args.work = os.path.abspath(args.places[-1])
    args.build = os.path.abspath(args.places[0])
    os.makedirs(args.work, exist_ok=True)
    {"record": record, "calibrate": calibrate, "table": table}[args.what](args)


if __name__ == "__main__":
    main()
