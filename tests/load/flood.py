#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Far more connections than the daemon takes, all at once: how soon each is told, and when all is as before.

usage: flood.py [CONNECTIONS [LIMIT]]     default: 10000 against a limit of 256
"""

import collections
import os
import resource
import select
import socket
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "live"))
from live import machine, say, table, working_cell  # noqa: E402  first: it knows where cell is
from cell import wait_until  # noqa: E402
from holdings import Holdings  # noqa: E402

REQUEST = b"GET /livez HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
AT_ONCE = 200  # begun between two looks at what has come
PATIENCE_S = 30.0


class Flood:
    """Connections that all ask once and stay until they are closed."""

    def __init__(self, port: int):
        self.port = port
        self.poll = select.epoll()
        self.open: dict[int, tuple[socket.socket, float]] = {}  # and when it was begun
        self.said: dict[int, bytes] = {}
        self.how: collections.Counter = collections.Counter()
        self.refused_after_s: list[float] = []

    def begin(self) -> None:
        connection = socket.socket()
        connection.setblocking(False)
        connection.connect_ex(("127.0.0.1", self.port))
        self.open[connection.fileno()] = (connection, time.monotonic())
        self.said[connection.fileno()] = b""
        self.poll.register(connection.fileno(), select.EPOLLOUT | select.EPOLLIN)

    def look(self, wait_s: float) -> None:
        for number, event in self.poll.poll(wait_s, 2000):
            connection, begun = self.open[number]
            try:
                if event & select.EPOLLOUT:
                    self.poll.modify(number, select.EPOLLIN)
                    connection.send(REQUEST)
                if event & ~select.EPOLLOUT:
                    self.read(number, connection, begun)
            except BlockingIOError:
                pass
            except OSError as failure:
                self.end(number, "reset, 503 read" if b" 503 " in self.said[number] else type(failure).__name__)

    def read(self, number: int, connection: socket.socket, begun: float) -> None:
        data = connection.recv(4096)
        self.said[number] += data
        if data:
            return
        whole = self.said[number].rstrip().endswith(b"}") and b" 503 " in self.said[number][:32]
        if whole:
            self.refused_after_s.append(time.monotonic() - begun)
        self.end(number, "503, then closed" if whole else "closed without a word")

    def end(self, number: int, how: str) -> None:
        self.how[how] += 1
        self.said.pop(number)
        self.poll.unregister(number)
        self.open.pop(number)[0].close()

    def served(self) -> int:
        return sum(text.startswith(b"HTTP/1.1 200") for text in self.said.values())


def flood(port: int, count: int, limit: int) -> dict:
    """All are begun, and all but those that are served have ended."""
    them, begin = Flood(port), time.monotonic()
    for i in range(count):
        them.begin()
        if i % AT_ONCE == 0:
            them.look(0)
    while len(them.open) > them.served() and time.monotonic() < begin + PATIENCE_S:
        them.look(0.05)
    took, served = time.monotonic() - begin, them.served()
    for number in list(them.open):
        them.end(number, "served" if them.said[number].startswith(b"HTTP/1.1 200") else "no answer")
    after = sorted(them.refused_after_s) or [float("nan")]
    return {"connections": count, "limit": limit, "served": served, "how": dict(them.how), "all_told_after_s": round(took, 2),
            "refused_after_s_median": round(after[len(after) // 2], 3), "refused_after_s_p99": round(after[int(0.99 * len(after))], 3),
            "refused_after_s_most": round(after[-1], 3)}


def measure(daemon, count: int, limit: int) -> dict:
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, count + 1000), hard))
    before = Holdings.of(daemon.process.pid)
    line = flood(daemon.port, count, limit)
    begin = time.monotonic()
    wait_until("it serves again", lambda: daemon.get("/livez").status == 200, 30, 0.01)
    line["serves_again_after_s"] = round(time.monotonic() - begin, 3)
    wait_until("its descriptors are closed", lambda: Holdings.of(daemon.process.pid).descriptors <= before.descriptors, 30, 0.01)
    line["descriptors_closed_after_s"] = round(time.monotonic() - begin, 3)
    return {**line, "grown": Holdings.of(daemon.process.pid).minus(before), "load_average": round(os.getloadavg()[0], 1)}


def main(count: int = 10_000, limit: int = 256) -> None:
    lines = []
    with working_cell(f"server.max_connections={limit}", "server.loopback_rate_limit=0") as (_, daemon):
        for _ in range(3):  # what grows, grows with each
            lines.append(measure(daemon, count, limit))
            say(**lines[-1])
    keys = ("served", "how", "refused_after_s_median", "refused_after_s_p99", "refused_after_s_most", "serves_again_after_s",
            "descriptors_closed_after_s", "grown")
    table([key.replace("_", " ") for key in keys], [[line[key] for key in keys] for line in lines])
    print(machine())


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
