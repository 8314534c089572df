#!/usr/bin/env python3
"""How often the posterior holds the truth, over records of another code with nothing concealed. Needs Python 3 alone.

  coverage_of_posterior.py run   BUILD_DIR WORK_DIR [--cases N] [--seed S] [--suite DIR] [--threads T] [--set table.key=value]...
  coverage_of_posterior.py table WORK_DIR [--with EARLIER.csv]...

`run` has `calomel challenge make` record N slices by the reference generator (its own mesh, step, viscosity, steel, gauge places, gains, pulse length and energies, all drawn by the seed),
samples each posterior on meshes of 2 and 1 mm (--set 'emulator.element_sizes=[1e-3,0.5e-3]' for others), and beside it, on the same emulator and the same runs, the posteriors under the forms of `[posterior] compare`. A case
that is done is not done again, and one that was cut off goes on from its runs. --suite takes those cases of a suite in which nothing is concealed in place of making one.
`table` counts how often the central intervals of each parameter and the joint region of the three hold the truth, with exact binomial intervals (Clopper and Pearson 1934) of
95 %, and writes coverage.csv, a line a case, form and parameter. --with counts the lines of other suites too.
"""
import argparse
import csv
import json
import math
import os
import subprocess
import sys

FORMS = ("no_mesh_errors", "independent")
LABELS = {"posterior": "this posterior", "no_mesh_errors": "no mesh errors, no numerical noise", "independent": "independent errors at every sample (published form)"}
SET = ('solver.precision="single"', "emulator.element_sizes=[2e-3,1e-3]", 'emulator.start="nominal"', "posterior.compare=[" + ",".join(f'"{f}"' for f in FORMS) + "]")


def case_names(work):
    folder = os.path.join(work, "suite", "cases")
    return sorted(os.listdir(folder)) if os.path.isdir(folder) else []


def make_suite(args, program, suite):
    if args.suite:
        os.makedirs(args.work, exist_ok=True)
        if not os.path.lexists(suite):
            os.symlink(os.path.abspath(args.suite), suite)
        return
    subprocess.run([program, "challenge", "make", "--seed", str(args.seed), "--out", suite, "--none", str(args.cases), "--single", "0", "--outside", "0", "--sensor", "0", "--pair", "0",
                    "--threads", str(args.threads)], check=True)


def run(args):
    program = os.path.join(args.build, "apps", "calomel")
    suite = os.path.join(args.work, "suite")
    make_suite(args, program, suite)
    failed = 0
    for name in case_names(args.work):
        if conceals(args.work, name):
            continue
        out = os.path.join(args.work, name)
        command = [program, "sample", os.path.join(suite, "cases", name, "case.toml"), "--out", out, "--threads", str(args.threads), "--quiet"]
        for s in (*SET, *args.set):
            command += ["--set", s]
        status = subprocess.run(command).returncode  # 0: converged; 4: not to be trusted, and counted all the same
        if status not in (0, 4):
            failed += 1
            print(f"{name}: exit status {status}", file=sys.stderr)
    return 1 if failed else 0


def conceals(work, name):
    """Whether the truth of a case has an effect."""
    with open(os.path.join(work, "suite", "truth", name + ".toml"), encoding="utf-8") as f:
        return any(line.startswith("[[effect]]") for line in f)


def seed_of(work):
    with open(os.path.join(work, "suite", "suite.json"), encoding="utf-8") as f:
        return str(json.load(f)["provenance"]["seed"])


def truth_of(suite, name):
    """[parameter] of the truth of a case, by name."""
    values, table = {}, ""
    with open(os.path.join(suite, "truth", name + ".toml"), encoding="utf-8") as f:
        for line in f:
            line = line.split("#")[0].strip()
            if line.startswith("["):
                table = line.strip("[]")
            elif table == "parameter" and "=" in line:
                key, value = line.split("=")
                values[key.strip()] = float(value)
    return values


def solve(matrix, right):
    """x of matrix x = right, by Gauss with pivots."""
    n = len(right)
    rows = [list(row) + [r] for row, r in zip(matrix, right)]
    for i in range(n):
        p = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[p] = rows[p], rows[i]
        for k in range(i + 1, n):
            f = rows[k][i] / rows[i][i]
            rows[k] = [a - f * b for a, b in zip(rows[k], rows[i])]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - sum(rows[i][k] * x[k] for k in range(i + 1, n))) / rows[i][i]
    return x


def square_distance(region, truth):
    """(truth - mean)' covariance^-1 (truth - mean), in units of each parameter's deviation."""
    names, cov = region["parameters"], region["covariance"]
    sd = [math.sqrt(cov[i][i]) for i in range(len(names))]
    off = [(truth[n] - m) / s for n, m, s in zip(names, region["mean"], sd)]
    return sum(a * b for a, b in zip(off, solve([[cov[i][j] / (sd[i] * sd[j]) for j in range(len(sd))] for i in range(len(sd))], off)))


def binomial_cdf(k, n, p):
    return sum(math.comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(k + 1))


def exact_interval(k, n, level=0.95):
    """Clopper and Pearson, by bisection of the binomial's tails."""

    def root(f):
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if f(middle) else (low, middle)
        return 0.5 * (low + high)

    tail = (1 - level) / 2
    return (0.0 if k == 0 else root(lambda p: 1 - binomial_cdf(k - 1, n, p) < tail), 1.0 if k == n else root(lambda p: binomial_cdf(k, n, p) > tail))


def rows_of(work, name):
    """One row a form and parameter, and one of the joint region; none where the case is not done."""
    path = os.path.join(work, name, "posterior.json")
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as f:
        result = json.load(f)
    truth, seed = truth_of(os.path.join(work, "suite"), name), seed_of(work)
    rows = []
    for form, part in [("posterior", result)] + [(form, result["compared"][form]) for form in FORMS]:
        region = part["regions"]
        shares = {round(100 * s["share"]): s for s in region["shares"]}
        base = {"seed": seed, "case": name, "form": form, "converged": part["converged"]}
        for i, parameter in enumerate(region["parameters"]):
            sd, t = math.sqrt(region["covariance"][i][i]), truth[parameter]
            rows.append({**base, "what": parameter, "truth": t, "mean": region["mean"][i], "sd": sd, "deviations": (region["mean"][i] - t) / sd,
                         **{f"in_{p}": int(shares[p]["low"][i] <= t <= shares[p]["high"][i]) for p in (50, 90)}})
        square = square_distance(region, truth)
        rows.append({**base, "what": "joint", "truth": "", "mean": "", "sd": "", "deviations": math.sqrt(square), **{f"in_{p}": int(square <= shares[p]["square_radius"]) for p in (50, 90)}})
    return rows


def earlier_rows(path):
    """Rows of a coverage.csv."""
    rows = []
    with open(path, newline="", encoding="utf-8") as f:
        for row in csv.DictReader(f):
            for key in ("mean", "sd", "deviations"):
                row[key] = float(row[key]) if row[key] else ""
            rows.append({**row, "converged": row["converged"] == "True", "in_50": int(row["in_50"]), "in_90": int(row["in_90"])})
    return rows


def share_text(k, n):
    low, high = exact_interval(k, n)
    return f"{k} of {n} ({100 * low:.0f} to {100 * high:.0f} %)"


def table(args):
    rows = [row for name in case_names(args.work) for row in rows_of(args.work, name)]
    own = len(rows)
    for earlier in args.earlier:
        rows += earlier_rows(earlier)
    if not rows:
        print("no case is done yet", file=sys.stderr)
        return 1
    with open(os.path.join(args.work, "coverage.csv"), "w", newline="", encoding="utf-8") as f:
        out = csv.DictWriter(f, rows[0].keys())
        out.writeheader()
        out.writerows(rows[:own])
    cases = {(r["seed"], r["case"]) for r in rows}
    whats = [w for w in dict.fromkeys(r["what"] for r in rows)]
    sure = sum(r["converged"] for r in rows if r["form"] == "posterior" and r["what"] == "joint")
    print(f"{len(cases)} records, {sure} of them with a posterior that says it is to be trusted\n")
    print("| errors | of | 50 % holds | 90 % holds | rms distance in deviations | median sd |\n|---|---|---|---|---|---|")
    for form in LABELS:
        for what in whats:
            own = [r for r in rows if r["form"] == form and r["what"] == what]
            n, rms = len(own), math.sqrt(sum(r["deviations"] ** 2 for r in own) / len(own))
            relative = "" if what == "joint" else f"{100 * sorted(r['sd'] / r['mean'] for r in own)[n // 2]:.2g} %"
            print(f"| {LABELS[form]} | {what} | {share_text(sum(r['in_50'] for r in own), n)} | {share_text(sum(r['in_90'] for r in own), n)} | {rms:.2g} | {relative} |")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    runs = verbs.add_parser("run")
    runs.add_argument("build")
    runs.add_argument("work")
    runs.add_argument("--cases", type=int, default=5)
    runs.add_argument("--seed", type=int, default=1)
    runs.add_argument("--suite")
    runs.add_argument("--threads", type=int, default=1)
    runs.add_argument("--set", action="append", default=[])
    tables = verbs.add_parser("table")
    tables.add_argument("work")
    tables.add_argument("--with", dest="earlier", action="append", default=[])
    args = parser.parse_args()
    return run(args) if args.verb == "run" else table(args)


if __name__ == "__main__":
    sys.exit(main())
