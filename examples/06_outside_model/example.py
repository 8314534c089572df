#!/usr/bin/env python3
"""Runs the example from its server to its numbers, and holds them against those of the README.

usage: example.py CALOMEL WORK     exit status 1 where a number differs
"""
import json, os, shutil, subprocess, sys

HERE = os.path.dirname(os.path.abspath(__file__))
calomel, work = sys.argv[1:3]
shutil.rmtree(work, ignore_errors=True)
os.makedirs(work)
for name in ("case.toml", "record.csv"):
    shutil.copy(os.path.join(HERE, name), work)
case, wrong = os.path.join(work, "case.toml"), []

def run(*words, statuses=(0,)):
    print("calomel", *words, flush=True)
    status = subprocess.run([calomel, words[0], case, "--set", f'model.url="{url}"', *words[1:]]).returncode
    if status not in statuses:
        sys.exit(f"exit status {status}")

def expect(what, value, wanted, within):
    ok = abs(value - wanted) <= within
    print(f"{what:40s} {value:12.6g}   expected {wanted:.6g} +- {within:.2g}   {'' if ok else 'DIFFERS'}", flush=True)
    if not ok:
        wrong.append(what)

def summary(out, name):
    with open(os.path.join(work, out, name)) as f:
        return json.load(f)

server = subprocess.Popen([sys.executable, os.path.join(HERE, "beam_server.py"), "--port", "0"], stdout=subprocess.PIPE, text=True)
try:
    url = server.stdout.readline().strip()
    run("check")
    run("diagnose", "--set", "diagnosis.leaders=2", "--out", os.path.join(work, "diagnosis"))  # of the four explanations that lead to first order, the two of physics
    found = summary("diagnosis", "diagnosis.json")
    print(found["verdict"], found["mechanisms"])
    if (found["verdict"], found["mechanisms"]) != ("named", ["air_drag"]):
        wrong.append("verdict")
    drag = found["ranking"][0]["parameters"][0]
    expect("air drag in the diagnosis", drag["mean"], 0.0022, 3e-4)
    with_drag = ("--set", "mechanism.air_drag.enabled=true", "--set", 'surrogate.kind="network"', "--out", os.path.join(work, "with_drag"))
    run("calibrate", "--method", "map", *with_drag, statuses=(0, 4))
    run("sample", *with_drag)
    theta = {p["name"]: p for p in summary("with_drag", "posterior.json")["parameters"]}
    for name, truth, within in (("frequency", 9.83, 1e-3), ("damping", 0.0041, 1e-4), ("air_drag.coefficient", 0.0022, 1e-4)):
        expect(f"{name}, posterior mean", theta[name]["mean"], truth, within)
    expect("map and posterior mean of the drag", summary("with_drag", "map.json")["theta"]["air_drag.coefficient"], theta["air_drag.coefficient"]["mean"], theta["air_drag.coefficient"]["sd"])
finally:
    server.terminate()
    server.wait()
if wrong:
    sys.exit("differs: " + ", ".join(wrong))
