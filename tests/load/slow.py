#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Clients that are slow on purpose, beside clients that poll the pose: what the latter notice, and what it costs.

usage: slow.py [SECONDS [SENDERS [READERS]]]     default: 60 s, 2000 that send a byte every 10 s, 500 that read nothing
"""

import contextlib
import json
import os
import resource
import subprocess
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "live"))
from live import machine, say, table, working_cell  # noqa: E402  first: it knows where cell is
from cell import SENSOR, wait_until  # noqa: E402
from holdings import Holdings  # noqa: E402
import open_loop  # noqa: E402

POSE = f"/api/v1/sensors/{SENSOR}/pose"
LIMIT = 4096
POLLERS, ASKED_PER_S = 50, 500


class Held:
    """holders.py at work, and what it said last."""

    def __init__(self, port: int, *arguments):
        command = [sys.executable, "-B", str(Path(__file__).with_name("holders.py")), str(port), *map(str, arguments)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.last = {"held": 0}
        self.reader = threading.Thread(target=self.listen, daemon=True)
        self.reader.start()

    def listen(self) -> None:
        for line in self.process.stdout:
            self.last = json.loads(line)

    def end(self) -> dict:
        with contextlib.suppress(OSError):
            self.process.stdin.close()
        self.process.wait(30)
        self.reader.join(5)
        self.process.stdout.close()
        return self.last


def tcp_memory_kib() -> int:
    """Of the whole machine: also of connections that no process has any more, which are nobody's memory otherwise."""
    words = next(line for line in Path("/proc/net/sockstat").read_text().splitlines() if line.startswith("TCP:")).split()
    return int(words[words.index("mem") + 1]) * resource.getpagesize() // 1024


class Highest:
    """The most memory (KiB) that a process and the kernel for its connections have while this runs."""

    def __init__(self, pid: int):
        self.pid, self.most, self.most_of_kernel, self.ending = pid, 0, 0, threading.Event()
        self.thread = threading.Thread(target=self.look, daemon=True)
        self.thread.start()

    def look(self) -> None:
        while not self.ending.wait(0.1):
            self.most = max(self.most, Holdings.of(self.pid).memory_kib)
            self.most_of_kernel = max(self.most_of_kernel, tcp_memory_kib())

    def end(self) -> "Highest":
        self.ending.set()
        self.thread.join()
        return self


def measure(daemon, seconds: float, senders: int, readers: int) -> dict:
    """Memory and latency beside the slow ones; then, that they leave nothing behind."""
    before, kernel_before = Holdings.of(daemon.process.pid), tcp_memory_kib()
    alone = open_loop.result(open_loop.start(daemon.port, POSE, ASKED_PER_S, POLLERS, min(10.0, seconds)))
    load = open_loop.start(daemon.port, POSE, ASKED_PER_S, POLLERS, seconds)  # they are there first, and stay
    highest = Highest(daemon.process.pid)
    slow_senders, slow_readers = Held(daemon.port, "senders", senders), Held(daemon.port, "readers", readers)
    wait_until("all are held", lambda: slow_senders.last["held"] >= senders and slow_readers.last["held"] >= readers, seconds)
    beside = open_loop.result(load)
    sent, unread = slow_senders.end(), slow_readers.end()
    most = highest.end()

    def left() -> bool:
        return Holdings.of(daemon.process.pid).descriptors <= before.descriptors
    begin = time.monotonic()
    wait_until("the slow ones' descriptors are closed", left, 30)
    return {"senders": sent, "readers": unread, "alone_p99_ms": alone["p99_ms"], "p99_ms": beside["p99_ms"],
            "p999_ms": beside["p999_ms"], "most_ms": beside["most_ms"], "statuses": beside["statuses"],
            "unanswered": beside["unanswered"], "failed_connections": beside["failed_connections"],
            "memory_before_mib": round(before.memory_kib / 1024), "memory_most_mib": round(most.most / 1024),
            "kernel_before_mib": round(kernel_before / 1024), "kernel_most_mib": round(most.most_of_kernel / 1024),
            "kernel_after_mib": round(tcp_memory_kib() / 1024),
            "descriptors_closed_after_s": round(time.monotonic() - begin, 2), "load_average": round(os.getloadavg()[0], 1)}


def main(seconds: float = 60, senders: float = 2000, readers: float = 500) -> None:
    with working_cell(f"server.max_connections={LIMIT}", "server.loopback_rate_limit=0") as (_, daemon):
        line = measure(daemon, seconds, int(senders), int(readers))
        say(**line)
    table(["50 clients, 500 requests/s", "p99, ms", "most, ms"],
          [["alone", line["alone_p99_ms"], ""], [f"beside {int(senders)} slow senders and {int(readers)} readers", line["p99_ms"],
                                                 line["most_ms"]]])
    print(f"longest that a sender was left: {line['senders']['longest_s']} s; memory {line['memory_before_mib']} MiB before, "
          f"{line['memory_most_mib']} MiB at most; the kernel for all "
          f"connections {line['kernel_before_mib']}, {line['kernel_most_mib']} MiB; {machine()}")


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
