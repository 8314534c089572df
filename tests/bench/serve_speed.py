#!/usr/bin/env python3
"""Requests a second of `calomel serve`, by request and by number of clients. Needs Python 3 alone.

  serve_speed.py BUILD_DIR WORK_DIR [--clients 1,2,4,8] [--requests 20000] [--seconds 1] [--repeats 5] [--threads 2]

It trains a surrogate of a small slice (40 runs), serves the slice and the surrogate at a free port of 127.0.0.1 and asks over raw sockets, so that little of the time is the client's. A repeat ends
after `--requests` requests of each client or `--seconds` seconds, whichever comes first. Every client has one connection of its own, in a process of its own; "new" opens a connection for each request. Every answer
must have status 200 and, of the same request, the same bytes. The table gives least, median and greatest rate of the repeats, all clients together. What is trained already in WORK_DIR is used again.
"""
import argparse
import json
import multiprocessing
import os
import re
import signal
import socket
import statistics
import subprocess
import sys
import time

CASE = """[case]
name = "slice to serve"
[geometry]
kind = "box"
length = 0.06
width = 0.10
height = 0.03
wall = 0.003
rear = "non_reflecting"
plane_strain = true
element_size = 0.003
[material.steel]
density = 7960.0
young = 193e9
poisson = 0.29
[material.mercury]
density = 13500.0
sound_speed = 1450.0
tensile_cutoff = 1.5e5
[load]
peak_pressure = 25e6
[load.profile]
center = [0.0, 0.015]
widths = [1000.0, 0.02]
decay = 0.13
buildup = 1.5
buildup_length = 0.02
exponent = 2.0
[time]
end = 100e-6
output_interval = 1e-6
[[sensor]]
name = "A"
position = [0.02, 0.0, 0.03]
direction = [1, 0, 0]
[[sensor]]
name = "B"
position = [0.04, 0.0, 0.03]
direction = [1, 0, 0]
[parameter.tensile_cutoff]
min = 5e4
max = 3e5
[parameter.density]
min = 12500.0
max = 14000.0
[parameter.sound_speed]
min = 1380.0
max = 1520.0
[campaign]
runs = 40
floor = false
[surrogate]
compare = []
"""
THETA = [1.5e5, 13500.0, 1450.0]
HOST = "127.0.0.1"


def request(path, body=None):
    """The bytes of one request."""
    text = b"" if body is None else json.dumps(body).encode()
    verb = "GET" if body is None else "POST"
    return f"{verb} {path} HTTP/1.1\r\nHost: {HOST}\r\nContent-Length: {len(text)}\r\n\r\n".encode() + text


def connect(port):
    s = socket.create_connection((HOST, port), timeout=60)
    s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return s


def ask(s, message):
    """Status and body of the answer to `message`."""
    s.sendall(message)
    got = b""
    while (end := got.find(b"\r\n\r\n")) < 0:
        piece = s.recv(1 << 16)
        if not piece:
            raise OSError("the server closed the connection")
        got += piece
    size = end + 4 + int(re.search(rb"(?i)content-length: *(\d+)", got[:end]).group(1))
    while len(got) < size:
        got += s.recv(1 << 16)
    return int(got[9:12]), got[end + 4:]


def client(port, message, requests, seconds, new, start, answers):
    """One client: puts (requests, begin, end [s], the answer) or what went wrong."""
    try:
        s = connect(port)
        status, first = ask(s, message)
        start.wait(60)
        began, n = time.monotonic(), 0
        while n < requests and time.monotonic() < began + seconds:
            if new:
                s.close()
                s = connect(port)
            status, body = ask(s, message)
            if status != 200 or body != first:
                raise OSError(f"status {status}, {body[:200]}")
            n += 1
        answers.put((n, began, time.monotonic(), first))
    except Exception as e:  # reported by the parent
        answers.put(str(e) or repr(e))


def rate(port, message, clients, a, new):
    """Requests a second of all clients together, and the answer."""
    start, answers = multiprocessing.Barrier(clients), multiprocessing.Queue()
    all_ = [multiprocessing.Process(target=client, args=(port, message, a.requests, a.seconds, new, start, answers)) for _ in range(clients)]
    for p in all_:
        p.start()
    results = [answers.get(timeout=120) for _ in all_]
    for p in all_:
        p.join()
    if wrong := [t for t in results if isinstance(t, str)]:
        sys.exit(wrong[0])
    if len({t[3] for t in results}) != 1:
        sys.exit("two clients got different answers to one request")
    return sum(t[0] for t in results) / (max(t[2] for t in results) - min(t[1] for t in results)), results[0][3]


def serve(program, case, out, threads):
    """The server and its port."""
    server = subprocess.Popen([program, "serve", case, "--out", out, "--port", "0", "--threads", str(threads)], stderr=subprocess.PIPE, text=True)
    for line in server.stderr:
        if at := re.search(r"at http://127\.0\.0\.1:(\d+)", line):
            return server, int(at.group(1))
    sys.exit(f"the server did not start (status {server.wait()})")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build")
    p.add_argument("work")
    p.add_argument("--clients", default="1,2,4,8")
    p.add_argument("--requests", type=int, default=20000)
    p.add_argument("--seconds", type=float, default=1)
    p.add_argument("--repeats", type=int, default=5)
    p.add_argument("--threads", type=int, default=2)
    a = p.parse_args()
    os.makedirs(a.work, exist_ok=True)
    program, case, out = os.path.join(a.build, "apps", "calomel"), os.path.join(a.work, "case.toml"), os.path.join(a.work, "out")
    with open(case, "w") as f:
        f.write(CASE)
    done = subprocess.run([program, "train", case, "--out", out, "--threads", str(a.threads), "--quiet"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    server, port = serve(program, case, out, a.threads)
    try:
        s = connect(port)
        sizes = json.loads(ask(s, request("/OutputSizes", {"name": "surrogate"}))[1])["outputSizes"]
        if not json.loads(ask(s, request("/ModelInfo", {"name": "surrogate"}))[1])["support"]["Gradient"]:
            sys.exit("the surrogate has no gradient")
        s.close()
        sens = [1.0 / (i + 1) for i in range(sizes[0])]
        asked = [("/Info", request("/Info")), ("/ModelInfo", request("/ModelInfo", {"name": "surrogate"})),
                 ("/Evaluate, surrogate", request("/Evaluate", {"name": "surrogate", "input": [THETA]})),
                 ("/Gradient, surrogate", request("/Gradient", {"name": "surrogate", "input": [THETA], "outWrt": 0, "inWrt": 0, "sens": sens})),
                 ("/Evaluate, forward (a run)", request("/Evaluate", {"name": "forward", "input": [THETA]}))]
        print(f"{sizes[0]} values; {a.threads} threads of the server; {a.repeats} repeats\n\n| request | connection | clients | least | median | greatest | answer [bytes] |\n|---|---|---|---|---|---|---|")
        for name, message in asked:
            for clients, new in [(int(c), False) for c in a.clients.split(",")] + [(1, True)]:
                rates = []
                for _ in range(a.repeats):
                    r, answer = rate(port, message, clients, a, new)
                    rates.append(r)
                print(f"| {name} | {'new' if new else 'kept'} | {clients} | {min(rates):.0f} | {statistics.median(rates):.0f} | {max(rates):.0f} | {len(answer)} |", flush=True)
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(30)


if __name__ == "__main__":
    main()
