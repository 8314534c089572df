#!/usr/bin/env python3
"""A model behind UM-Bridge 1.0 in Python's standard library: the free vibration of a cantilever after it is let go, seen by two strain gauges.

usage: beam_server.py [--port 4243]     listens on this machine alone; port 0 takes any that is free; the first line printed names it

inputs [2, 1, 1]   first natural frequency [Hz] and damping ratio; coefficient of quadratic air drag [1/mm] (off at 0); dry friction of the clamp over the
                   initial spring force [-] (off at 0)
outputs [400]      strain [microstrain] of gauges "root" and "middle" at 200 times, 0 to 0.995 s, every 5 ms

Two bending modes, the second at 6.267 times the first frequency (Euler and Bernoulli), each driven by its share of both forces; semi-implicit Euler steps of 0.05 ms.
"""
import json, math, sys
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

RATIO, RELEASED, STRAIN = 6.267, (4.0, 0.3), ((50.0, 210.0), (17.0, -120.0))   # mm; microstrain per mm of each mode
STEP, EVERY, COUNT = 5e-5, 100, 200
SIZES = [2, 1, 1]

def beam(blocks):
    (frequency, damping), (drag,), (friction,) = blocks
    w1, w2 = 2 * math.pi * frequency, 2 * math.pi * frequency * RATIO
    k1, k2, c1, c2 = w1 ** 2, w2 ** 2, 2 * damping * w1, 2 * damping * w2
    rub, tanh = friction * w1 ** 2 * RELEASED[0], math.tanh
    (x1, x2), v1, v2 = RELEASED, 0.0, 0.0
    out = ([], [])
    for _ in range(COUNT):
        for gauge, record in zip(STRAIN, out):
            record.append(gauge[0] * x1 + gauge[1] * x2)
        for _ in range(EVERY):
            v1 += STEP * (-k1 * x1 - c1 * v1 - drag * abs(v1) * v1 - rub * tanh(v1 / 0.5))
            v2 += STEP * (-k2 * x2 - c2 * v2 - drag * abs(v2) * v2)
            x1 += STEP * v1
            x2 += STEP * v2
    return [out[0] + out[1]]

def refused(kind, message, status=400):
    return status, {"error": {"type": kind, "message": message}}

def answer(path, q):
    """the reply to a POST: status and body"""
    if not isinstance(q, dict) or q.get("name") != "cantilever":
        return refused("ModelNotFound", "the only model is \"cantilever\"")
    if path == "/ModelInfo":
        return 200, {"support": {"Evaluate": True, "Gradient": False, "ApplyJacobian": False, "ApplyHessian": False}}
    if path == "/InputSizes":
        return 200, {"inputSizes": SIZES}
    if path == "/OutputSizes":
        return 200, {"outputSizes": [2 * COUNT]}
    if path != "/Evaluate":
        return refused("UnsupportedFeature", path)
    x = q.get("input")
    whole = isinstance(x, list) and [len(b) if isinstance(b, list) else -1 for b in x] == SIZES
    if not whole or not all(isinstance(n, (int, float)) and not isinstance(n, bool) and math.isfinite(n) for b in x for n in b):
        return refused("InvalidInput", f"input must be finite numbers in blocks of {SIZES}")
    if x[0][0] <= 0 or x[0][0] > 100:
        return refused("InvalidInput", "the frequency must lie above 0 and not above 100 Hz")
    y = beam(x)
    if not all(map(math.isfinite, y[0])):
        return refused("InvalidOutput", "the integration has run away", 500)
    return 200, {"output": y}

class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True
    wbufsize = -1

    def log_message(self, *_):
        pass

    def reply(self, status, body):
        data = json.dumps(body).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)
        self.wfile.flush()

    def do_GET(self):
        self.reply(*((200, {"protocolVersion": 1.0, "models": ["cantilever"]}) if self.path == "/Info" else refused("NotFound", self.path, 404)))

    def do_POST(self):
        body = self.rfile.read(int(self.headers.get("Content-Length", "0")))
        try:
            q = json.loads(body)
        except ValueError:
            return self.reply(*refused("InvalidInput", "the body is not JSON"))
        self.reply(*answer(self.path, q))

if __name__ == "__main__":
    port = int(sys.argv[sys.argv.index("--port") + 1]) if "--port" in sys.argv else 4243
    server = ThreadingHTTPServer(("127.0.0.1", port), Handler)
    server.daemon_threads = True
    print(f"http://127.0.0.1:{server.server_address[1]}", flush=True)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        pass
