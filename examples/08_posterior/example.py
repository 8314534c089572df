"""Runs the example and holds its posterior against the truth: example.py CALOMEL FOLDER"""
import json
import pathlib
import shutil
import subprocess
import sys
import tomllib

here = pathlib.Path(__file__).parent
program, out = sys.argv[1], pathlib.Path(sys.argv[2])
shutil.rmtree(out, ignore_errors=True)
subprocess.run([program, "sample", here / "posterior.toml", "--out", out, "--threads", "2", "--quiet"], check=True)
subprocess.run([program, "report", here / "posterior.toml", "--out", out], check=True)

case = tomllib.loads((here / "posterior.toml").read_text())
truth = tomllib.loads((here / "../recorder/box_slice.truth.toml").read_text())["parameter"]
posterior = json.loads((out / "posterior.json").read_text())
failed = 0


def holds(condition, what):
    global failed
    print("ok    " if condition else "FAILED", what)
    failed += not condition


holds(posterior["converged"], posterior["message"])
holds(posterior["true_model_check"]["holds"], posterior["true_model_check"]["sentence"])
holds(posterior["absorption"] == [], "no parameter sits far from what was known of it")
for p in posterior["parameters"]:
    if p["name"] not in truth:
        continue
    name, off = p["name"], (p["mean"] - truth[p["name"]]) / p["sd"]
    holds(abs(off) < 3, f"{name} {p['mean']:.5g} +- {p['sd']:.2g}, {off:+.1f} deviations from the true {truth[name]:.5g}")
    holds(p["r_hat"] < 1.01 and min(p["ess_bulk"], p["ess_tail"]) >= 400, f"{name}: R-hat {p['r_hat']:.3f}, ESS {p['ess_bulk']:.0f} and {p['ess_tail']:.0f}")
    if name == "tensile_cutoff":  # the nominal one would be found out
        nominal = case["material"]["mercury"]["tensile_cutoff"]
        holds(abs(p["mean"] - nominal) > 5 * p["sd"], f"{name}: more than 5 deviations from the nominal {nominal:.5g}")
page = (out / "report.html").read_text()
for part in ("prior-plot", "corner-plot", "predictive-plots", "chain-plot"):
    holds(f'id="{part}"' in page, f"report.html has {part}")
sys.exit(failed > 0)
