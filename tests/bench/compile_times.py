#!/usr/bin/env python3
"""Processor time of compiling, file by file, without a compiler cache. Needs Python 3 alone.

  compile_times.py BUILD_DIR [WORD]... [--csv FILE] [--most 10]

BUILD_DIR is configured with -DCMAKE_EXPORT_COMPILE_COMMANDS=ON. Each file whose path holds one of the words (all without words) is compiled once, one after
another, with the command of the build folder but into a temporary object. It prints a Markdown table of the dearest files, user and system seconds together,
and the sum over the library and program files and over those of tests. Processor seconds of a busy machine are longer than those of a quiet one.
"""
import argparse
import csv
import json
import os
import resource
import shlex
import subprocess
import sys
import tempfile


def seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build")
    p.add_argument("words", nargs="*")
    p.add_argument("--csv")
    p.add_argument("--most", type=int, default=10)
    a = p.parse_args()
    with open(os.path.join(a.build, "compile_commands.json")) as f:
        commands = json.load(f)
    with open(os.path.join(a.build, "CMakeCache.txt")) as f:
        source = next(line.split("=", 1)[1].strip() for line in f if line.startswith("CMAKE_HOME_DIRECTORY:"))
    rows = {}
    with tempfile.TemporaryDirectory() as scratch:
        for c in commands:
            name = os.path.relpath(c["file"], source)
            if a.words and not any(w in name for w in a.words):
                continue
            words = shlex.split(c["command"])
            words[words.index("-o") + 1] = os.path.join(scratch, "object.o")
            before = seconds()
            subprocess.run(words, cwd=c["directory"], check=True)
            rows[name] = max(rows.get(name, 0), seconds() - before)
            print(f"{rows[name]:8.2f} {name}", file=sys.stderr, flush=True)
    order = sorted(rows.items(), key=lambda r: -r[1])
    if a.csv:
        with open(a.csv, "w", newline="") as f:
            csv.writer(f).writerows([("file", "seconds"), *((n, f"{s:.2f}") for n, s in order)])
    print("| file | s |\n|---|---|")
    for name, s in order[: a.most]:
        print(f"| {name} | {s:.1f} |")
    tests = sum(s for n, s in order if n.startswith("tests/"))
    print(f"\n{len(order)} files: {sum(s for _, s in order) - tests:.0f} s of libraries, program and examples, {tests:.0f} s of tests")


if __name__ == "__main__":
    main()
