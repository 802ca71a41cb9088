#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Asks for a path at a fixed rate whatever the answers do, over connections that are kept, and measures each answer from
the moment its request was meant to leave. A process of its own, so that nothing of a test's delays it. JSON lines: one of
each interval, and one of all.

usage: open_loop.py PORT PATH RATE_PER_S CONNECTIONS SECONDS [INTERVAL_S]
"""

import collections
import contextlib
import gc
import json
import os
import select
import socket
import subprocess
import sys
import time
from pathlib import Path


class Connection:
    """One request at a time; those that come meanwhile wait, and their wait counts."""

    def __init__(self, port: int, request: bytes):
        self.port, self.request = port, request
        self.waiting: collections.deque[float] = collections.deque()
        self.asked_for: float | None = None
        self.failures = 0
        self.open()

    def open(self) -> None:
        self.received, self.length = b"", None
        self.socket = socket.create_connection(("127.0.0.1", self.port), timeout=10)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket.setblocking(False)

    def ask(self, meant: float) -> None:
        self.waiting.append(meant)
        if self.asked_for is None:
            self.send_next()

    def send_next(self) -> None:
        if self.waiting:
            self.asked_for = self.waiting.popleft()
            self.socket.sendall(self.request)

    def read(self) -> tuple[float, int] | None:
        """Latency (s) and status of an answer that has come in whole."""
        data = self.socket.recv(65536)
        if not data:
            raise ConnectionError("closed")
        self.received += data
        if self.length is None:
            end = self.received.find(b"\r\n\r\n")
            if end < 0:
                return None
            head = self.received[:end].lower()
            at = head.find(b"content-length:")
            self.length = end + 4 + (int(head[at + 15:].split(b"\r\n", 1)[0]) if at >= 0 else 0)
        if len(self.received) < self.length:
            return None
        answer = time.monotonic() - self.asked_for, int(self.received[9:12])
        self.received, self.length, self.asked_for = b"", None, None
        self.send_next()
        return answer

    def fail(self) -> None:
        self.failures += 1
        self.socket.close()
        self.asked_for = None
        self.open()
        self.send_next()


class Tally:
    """Latencies to a hundredth of a millisecond; of hours no more than of seconds is kept."""

    def __init__(self):
        self.hundredths_ms, self.statuses = collections.Counter(), collections.Counter()

    def add(self, latency_s: float, status: int) -> None:
        self.hundredths_ms[round(1e5 * latency_s)] += 1
        self.statuses[status] += 1

    def line(self) -> dict:
        count, passed, at = sum(self.hundredths_ms.values()), 0, {}
        shares = {"median_ms": 0.5, "p99_ms": 0.99, "p999_ms": 0.999, "most_ms": 1.0}
        for latency, number in sorted(self.hundredths_ms.items()):
            passed += number
            for name, share in shares.items():
                if name not in at and passed >= share * count:
                    at[name] = latency / 100
        return {"answers": count, "statuses": dict(self.statuses), **at}


def run(port: int, path: str, rate: float, connections: int, seconds: float, interval_s: float = 0) -> dict:
    request = f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode()
    peers = [Connection(port, request) for _ in range(connections)]
    begin, sent = time.monotonic() + 0.05, 0
    whole, part, part_ends = Tally(), Tally(), begin + interval_s
    while (now := time.monotonic()) < begin + seconds:
        while sent <= (now - begin) * rate:
            peers[sent % connections].ask(begin + sent / rate)
            sent += 1
        due = begin + sent / rate
        readable = select.select(by_socket := {p.socket: p for p in peers}, [], [], max(0.0, due - now))[0]
        for ready in readable:
            peer = by_socket[ready]
            try:
                if answer := peer.read():
                    whole.add(*answer)
                    part.add(*answer)
            except OSError:
                peer.fail()
        if interval_s and now >= part_ends:
            print(json.dumps(part.line()), flush=True)
            part, part_ends = Tally(), part_ends + interval_s
    unanswered = sum(len(p.waiting) + (p.asked_for is not None) for p in peers)
    return {"asked": sent, **whole.line(), "unanswered": unanswered, "failed_connections": sum(p.failures for p in peers)}


def start(port: int, path: str, rate: float, connections: int, seconds: float, interval_s: float = 0) -> subprocess.Popen:
    return subprocess.Popen([sys.executable, "-B", str(Path(__file__)), *map(str, (port, path, rate, connections, seconds, interval_s))],
                            stdout=subprocess.PIPE, text=True)


def result(process: subprocess.Popen) -> dict:
    lines = process.communicate()[0].splitlines()
    if process.returncode or not lines:
        raise AssertionError(f"the load ended with {process.returncode}")
    return json.loads(lines[-1])


if __name__ == "__main__":
    gc.disable()  # its pauses are not the daemon's
    with contextlib.suppress(OSError):
        os.nice(-5)
    numbers = [float(word) for word in sys.argv[3:]]
    print(json.dumps(run(int(sys.argv[1]), sys.argv[2], numbers[0], int(numbers[1]), *numbers[2:])), flush=True)
