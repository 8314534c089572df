#!/usr/bin/env python3
"""Diagnoses of models outside, behind UM-Bridge, whose records conceal a mechanism, a fault of a sensor, something that no mechanism is, or nothing. Needs Python 3 alone.

  outside_suite.py run   CALOMEL WORK_DIR [--seed S] [--repeats N] [--only SYSTEM] [--threads T] [--jitter J]
  outside_suite.py table WORK_DIR

Two systems: a mass on a spring that is let go (displacement and velocity), and a rod that is heated at one end (three thermometers). What is served is a coarse integration: semi-implicit Euler, and implicit
steps of 36 cells. The records come from another scheme (classical Runge and Kutta; Heun's on 60 cells), with four pulses, noise, gains within 1 % and parameters drawn about their priors. Of what is concealed the
strength is drawn so that it changes the mean records by 15 to 60 of their standard errors (root of the sum of squares), before any parameter makes up for it. `run` makes N cases of each kind and diagnoses
them; one that is done is not done again. With `--jitter` every value that is served is off by that share of it, drawn anew for every point, as of a simulation that chooses its steps itself. `table` counts the verdicts.
"""
import argparse
import json
import math
import os
import random
import subprocess
import sys
import threading
from http.server import ThreadingHTTPServer

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples", "06_outside_model"))
from beam_server import Handler  # noqa: E402

PULSES, GAIN_SD = 4, 0.005


class Oscillator:
    """x'' = -w^2 x - 2 z w x' - drag |x'| x' - friction w^2 sign(x') - cubic w^2 x^3, from x = 1; beyond the mechanisms: a second mass that hangs on the first."""
    sensors, start, step, count, noise = ("displacement", "velocity"), 0.0, 0.02, 150, (0.02, 0.02)
    parameters = {"frequency": (2.0, 0.02, 1.5, 2.5), "damping": (0.02, 0.004, 0.0, 0.1)}  # mean, sd, bounds
    mechanisms = {"drag": 0.3, "friction": 0.15, "cubic": 0.6}  # upper bound of the number; off at 0
    beyond = 0.2  # greatest share of the mass that hangs on it

    @staticmethod
    def slope(state, w, z, drag, friction, cubic, hung):
        x, v, y, u = state
        pull = hung * (0.8 * w) ** 2 * (y - x)
        a = -w * w * (x + cubic * x ** 3) - 2 * z * w * v - drag * w * abs(v / w) * v - friction * w * w * math.tanh(v / (0.05 * w)) + pull
        return (v, a, u, -(0.8 * w) ** 2 * (y - x) - 0.02 * w * u)

    def run(self, p, m, beyond=0.0, fine=False):
        w, z = 2 * math.pi * p[0], p[1]
        n = 20 if fine else 60
        h = self.step / n
        s, out = (1.0, 0.0, 0.0, 0.0), ([], [])
        for k in range(self.count):
            out[0].append(s[0]), out[1].append(s[1] / (2 * math.pi * 2.0))
            for _ in range(n):
                if fine:
                    f = lambda q: self.slope(q, w, z, *m, beyond)
                    a = f(s)
                    b = f([x + h / 2 * d for x, d in zip(s, a)])
                    c = f([x + h / 2 * d for x, d in zip(s, b)])
                    d = f([x + h * e for x, e in zip(s, c)])
                    s = tuple(x + h / 6 * (i + 2 * j + 2 * k2 + l) for x, i, j, k2, l in zip(s, a, b, c, d))
                else:
                    a = self.slope(s, w, z, *m, beyond)
                    v, u = s[1] + h * a[1], s[3] + h * a[3]
                    s = (s[0] + h * v, v, s[2] + h * u, u)
        return out


class Rod:
    """T' = (a (1 + b T) T')' - loss T - radiation T^4 of a rod of length 1, heated at one end during 0.1; beyond the mechanisms: b, a conductivity that grows with temperature."""
    sensors, start, step, count, noise = ("near", "middle", "far"), 0.0, 0.02, 60, (0.01, 0.01, 0.01)
    parameters = {"diffusivity": (0.2, 0.01, 0.05, 0.6), "heat": (1.0, 0.03, 0.5, 1.5)}
    mechanisms = {"loss": 1.0, "radiation": 0.5}
    beyond = 1.5

    def run(self, p, m, beyond=0.0, fine=False):
        cells, n = (60, 160) if fine else (36, 20)
        dx, h = 1.0 / cells, self.step / n
        t, out = [0.0] * cells, ([], [], [])
        places = (0.1, 0.4, 0.8)

        def source(time):
            return 8 * p[1] / dx if time < 0.1 - 1e-12 else 0.0

        def conductances(q):  # between cells
            return [p[0] / dx ** 2 * (1 + beyond * 0.5 * (a + b)) for a, b in zip(q, q[1:])]

        for k in range(self.count):
            for record, place in zip(out, places):
                at = place / dx - 0.5
                i = min(int(at), cells - 2)
                record.append(t[i] + (at - i) * (t[i + 1] - t[i]))
            for j in range(n):
                time = k * self.step + j * h
                if fine:  # explicit, of second order (Heun)
                    def rate(q, when):
                        r = [-m[0] * v - m[1] * v ** 4 for v in q]
                        for i, g in enumerate(conductances(q)):
                            flow = g * (q[i + 1] - q[i])
                            r[i] += flow
                            r[i + 1] -= flow
                        r[0] += source(when)
                        return r
                    a = rate(t, time)
                    b = rate([v + h * d for v, d in zip(t, a)], time)
                    t = [v + h / 2 * (d + e) for v, d, e in zip(t, a, b)]
                else:  # implicit, of first order: a tridiagonal system
                    conduct = conductances(t)
                    diagonal, right = [1 + h * (m[0] + m[1] * abs(v) ** 3) for v in t], list(t)
                    for i, g in enumerate(conduct):
                        diagonal[i] += h * g
                        diagonal[i + 1] += h * g
                    right[0] += h * source(time)
                    for i in range(1, cells):
                        f = h * conduct[i - 1] / diagonal[i - 1]
                        diagonal[i] -= f * h * conduct[i - 1]
                        right[i] += f * right[i - 1]
                    t[-1] = right[-1] / diagonal[-1]
                    for i in range(cells - 2, -1, -1):
                        t[i] = (right[i] + h * conduct[i] * t[i + 1]) / diagonal[i]
        return out


SYSTEMS = {"oscillator": Oscillator(), "rod": Rod()}


def serve(system, jitter):
    """Its server, on a free port of this machine; its address."""
    sizes = [len(system.parameters)] + [1] * len(system.mechanisms)

    def answer(path, q):
        if path == "/ModelInfo":
            return {"support": {"Evaluate": True, "Gradient": False, "ApplyJacobian": False, "ApplyHessian": False}}
        if path == "/InputSizes":
            return {"inputSizes": sizes}
        if path == "/OutputSizes":
            return {"outputSizes": [len(system.sensors) * system.count]}
        blocks = q["input"]
        r = random.Random(repr(blocks))
        return {"output": [[v * (1 + jitter * r.gauss(0, 1)) for v in sum(system.run(blocks[0], [b[0] for b in blocks[1:]]), [])]]}

    class Server(Handler):
        def do_GET(self):
            self.reply(200, {"protocolVersion": 1.0, "models": ["system"]})

        def do_POST(self):
            self.reply(200, answer(self.path, json.loads(self.rfile.read(int(self.headers["Content-Length"])))))

    server = ThreadingHTTPServer(("127.0.0.1", 0), Server)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_address[1]}"


def kinds(system):
    return ["none", *system.mechanisms, "sensor", "beyond"]


def distance(system, a, b):
    return math.sqrt(sum(((x - y) / (noise / math.sqrt(PULSES))) ** 2 for one, two, noise in zip(a, b, system.noise) for x, y in zip(one, two)))


def make(system, kind, seed, place):
    """case.toml without its address, record.csv, truth.json."""
    r = random.Random(f"{kind} {seed} {sorted(system.parameters)}")
    p = [mean + sd * max(-2, min(2, r.gauss(0, 1))) for mean, sd, _, _ in system.parameters.values()]
    wanted = math.exp(r.uniform(math.log(15), math.log(60)))
    names = list(system.mechanisms)
    faulty = r.randrange(len(system.sensors))
    base = system.run(p, [0.0] * len(names), fine=True)

    def concealing(share):
        if kind == "none":
            return base
        if kind == "sensor":
            return [[v * (1 - 0.15 * share) if s == faulty else v for v in one] for s, one in enumerate(base)]
        m = [share * system.mechanisms[n] if n == kind else 0.0 for n in names]
        return system.run(p, m, share * system.beyond if kind == "beyond" else 0.0, fine=True)

    share, low, high = 0.0, 0.0, 1.0
    if kind != "none":
        for _ in range(8):
            share = 0.5 * (low + high)
            low, high = (share, high) if distance(system, concealing(share), base) < wanted else (low, share)
    true = concealing(share)
    truth = {"kind": kind, "share": share, "distance": distance(system, true, base), "parameters": dict(zip(system.parameters, p))}
    if kind == "sensor":
        truth["sensor"] = system.sensors[faulty]
    elif kind in system.mechanisms:
        truth["number"] = share * system.mechanisms[kind]
    gains = [1 + GAIN_SD * r.gauss(0, 1) for _ in system.sensors]
    lines = ["sensor,pulse,time,strain"]
    for pulse in range(PULSES):
        for s, (one, noise) in enumerate(zip(true, system.noise)):
            lines += [f"{system.sensors[s]},{pulse},{system.start + system.step * i:.6g},{gains[s] * v + r.gauss(0, noise):.7g}" for i, v in enumerate(one)]
    case = ['[case]\nname = "outside"\nsensor_unit = "1"\n', '[model]\nkind = "umbridge"\nurl = "URL"\nname = "system"\n', "[output]\nsensors = " + json.dumps(system.sensors),
            f"time = {{ start = {system.start}, step = {system.step}, count = {system.count} }}\n", '[recordings]\nfile = "record.csv"\n', f"[errors]\ngain_sd = {GAIN_SD}\n"]
    for name, (mean, sd, least, most) in system.parameters.items():
        case.append(f'[parameter.{name}]\nmin = {least}\nmax = {most}\nprior = "normal"\nmean = {mean}\nsd = {sd}\n')
    for name, most in system.mechanisms.items():
        case.append(f"[mechanism.{name}.parameter.size]\noff = 0.0\nmin = 0.0\nmax = {most}\n")
    os.makedirs(place, exist_ok=True)
    for name, text in (("case.template", "\n".join(case)), ("record.csv", "\n".join(lines) + "\n"), ("truth.json", json.dumps(truth))):
        with open(os.path.join(place, name), "w") as f:
            f.write(text)


def run(args):
    for name, system in SYSTEMS.items():
        if args.only and name != args.only:
            continue
        url = serve(system, args.jitter)
        for kind in kinds(system):
            for repeat in range(args.repeats):
                place = os.path.join(args.work, f"{name}_{kind}_{args.seed}_{repeat}")
                if os.path.exists(os.path.join(place, "out", "diagnosis.json")):
                    continue
                if not os.path.exists(os.path.join(place, "truth.json")):
                    make(system, kind, 1000 * args.seed + repeat, place)
                with open(os.path.join(place, "case.template")) as f:
                    text = f.read().replace("URL", url)
                with open(os.path.join(place, "case.toml"), "w") as f:
                    f.write(text)
                with open(os.path.join(place, "log"), "w") as log:
                    status = subprocess.run([args.calomel, "diagnose", os.path.join(place, "case.toml"), "--out", os.path.join(place, "out"), "--threads", str(args.threads), "--fresh"],
                                            stdout=log, stderr=log).returncode
                if status not in (0, 4):
                    print(f"{place}: exit status {status}", file=sys.stderr)
    return 0


def table(args):
    rows, total = [], {}
    for name in sorted(os.listdir(args.work)):
        place = os.path.join(args.work, name)
        try:
            with open(os.path.join(place, "truth.json")) as f, open(os.path.join(place, "out", "diagnosis.json")) as g:
                truth, d = json.load(f), json.load(g)
        except FileNotFoundError:
            continue
        kind, said = truth["kind"], d["mechanisms"]
        right = {"none": d["verdict"] == "none", "beyond": d["verdict"] in ("unknown", "none"), "sensor": said == ["sensor_response"]}.get(kind, said == [kind])
        wrong = bool(said) and not right and kind not in said
        number = next((p for p in d["ranking"][0]["parameters"]), None) if right and kind in said else None
        number_text = "" if not number else f"{number['mean']:.3g} ± {number['sd']:.2g} (true {truth['number']:.3g})"
        family = f"{name.split('_')[0]}, {kind if kind in ('none', 'sensor', 'beyond') else 'a mechanism'}"
        count = total.setdefault(family, [0, 0, 0])
        count[0], count[1], count[2] = count[0] + 1, count[1] + right, count[2] + wrong
        rows.append(f"| {name} | {truth['distance']:.0f} | {d['verdict']} {'+'.join(said)} | {number_text} |")
    print("| case | distance | verdict | its number |\n|---|---|---|---|", *rows, sep="\n")
    print("\n| concealed | cases | right | wrong name |\n|---|---|---|---|", *[f"| {k} | {a} | {b} | {c} |" for k, (a, b, c) in sorted(total.items())], sep="\n")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    one = verbs.add_parser("run")
    one.add_argument("calomel"), one.add_argument("work")
    one.add_argument("--seed", type=int, default=1), one.add_argument("--repeats", type=int, default=3), one.add_argument("--only", choices=SYSTEMS), one.add_argument("--threads", type=int, default=1)
    one.add_argument("--jitter", type=float, default=0.0)
    verbs.add_parser("table").add_argument("work")
    args = parser.parse_args()
    return run(args) if args.verb == "run" else table(args)


if __name__ == "__main__":
    sys.exit(main())
