#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""GET pose over 64 connections that are kept, by wrk, against nginx serving a file of the same body: in the same run, in
turns, each on one core of its own, wrk on another.

usage: throughput.py [SECONDS [ROUNDS]]     default: 10 s of each, 5 rounds
"""

import contextlib
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "live"))
from live import machine, say, scratch, table, working_cell  # noqa: E402  first: it knows where cell is
from cell import SENSOR, call, free_port, wait_until  # noqa: E402
from holdings import children_of  # noqa: E402

POSE = f"/api/v1/sensors/{SENSOR}/pose"
CONNECTIONS = 64
SERVER_CORE, CLIENT_CORE = "0", "1"
NGINX = """daemon off; worker_processes 1; pid {folder}/pid; error_log stderr warn;
events {{ worker_connections 1024; }}
http {{ access_log off; sendfile on; tcp_nopush off; keepalive_requests 1000000000; open_file_cache max=16 inactive=1h; open_file_cache_valid 1h;
  default_type application/json;
  client_body_temp_path {folder}/a; proxy_temp_path {folder}/b; fastcgi_temp_path {folder}/c; uwsgi_temp_path {folder}/d;
  scgi_temp_path {folder}/e;
  server {{ listen 127.0.0.1:{port}; location / {{ root {folder}/www; }} }} }}
"""


def pin(pid: int, core: str) -> None:
    subprocess.run(["taskset", "-a", "-c", "-p", core, str(pid)], check=True, stdout=subprocess.DEVNULL)


@contextlib.contextmanager
def nginx(folder: Path, body: bytes):
    """Serves `body` at /pose; the port."""
    port, www = free_port(), folder / "www"
    www.mkdir()
    (www / "pose").write_bytes(body)
    folder.chmod(0o755)  # its worker may be another user
    (folder / "nginx.conf").write_text(NGINX.format(folder=folder, port=port))
    process = subprocess.Popen(["taskset", "-c", SERVER_CORE, "nginx", "-e", "stderr", "-c", folder / "nginx.conf"])
    try:
        wait_until("nginx serves", lambda: call(port, "GET", "/pose").body == body)
        yield port
    finally:
        process.terminate()
        process.wait()


def wrk(port: int, path: str, seconds: float) -> dict:
    command = ["taskset", "-c", CLIENT_CORE, "wrk", "-t1", f"-c{CONNECTIONS}", f"-d{seconds:.0f}s", "--latency",
               f"http://127.0.0.1:{port}{path}"]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    wrong = re.search(r"Socket errors.*|Non-2xx.*", told)
    return {"per_s": float(re.search(r"Requests/sec:\s*([\d.]+)", told)[1]), "p99": re.search(r"99%\s*(\S+)", told)[1],
            "wrong": wrong[0] if wrong else ""}


def compare(daemon, seconds: float, rounds: int) -> list[dict]:
    body = daemon.get(POSE).body
    lines = []
    with scratch() as (folder, _), nginx(folder, body) as port:
        for _ in range(rounds):
            theirs, ours = wrk(port, "/pose", seconds), wrk(daemon.port, POSE, seconds)
            lines.append({"body_bytes": len(body), "nginx": theirs, "calibrd": ours,
                          "ratio": round(ours["per_s"] / theirs["per_s"], 3), "load_average": round(os.getloadavg()[0], 1)})
            say(**lines[-1])
    return lines


def main(seconds: float = 10, rounds: float = 5) -> None:
    for program in ("wrk", "nginx", "taskset"):
        if not shutil.which(program):
            raise SystemExit(f"throughput: {program} is missing; scripts/setup.sh --load installs it")
    with working_cell("server.loopback_rate_limit=0") as (simulator, daemon):
        simulator.tell("PUT", "/motion", mode="hold")
        wait_until("the pose is valid", lambda: daemon.pose()["valid"])
        pin(daemon.process.pid, SERVER_CORE)
        for other in (simulator.process.pid, *children_of(daemon.process.pid)):
            pin(other, CLIENT_CORE)
        time.sleep(1)
        lines = compare(daemon, seconds, int(rounds))
    table(["served by", "requests/s, median", "least", "most"],
          [[name, *(round(f(line[name]["per_s"] for line in lines)) for f in (statistics.median, min, max))]
           for name in ("nginx", "calibrd")])
    print(f"ratio {statistics.median(line['ratio'] for line in lines):.2f}; {machine()}")


if __name__ == "__main__":
    os.environ["PATH"] += ":/usr/sbin"
    main(*map(float, sys.argv[1:]))
