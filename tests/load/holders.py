#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Clients that hold connections and give nothing back: a process of its own, which ends with its input. Prints one JSON
line a second, and one at the end.

usage: holders.py PORT senders COUNT [SECONDS_PER_BYTE]   a request byte by byte
       holders.py PORT readers COUNT                      ask for clouds and events, and read nothing
"""

import contextlib
import json
import select
import socket
import sys
import time

REQUEST = b"GET /api/v1/sensors/kinect2/pose HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: " + b"x" * 4096
CLOUD = b"GET /api/v1/sensors/kinect2/clouds/measured HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
EVENTS = b"GET /api/v1/events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
SMALL_BUFFER = 4096


class Holders:
    def __init__(self, port: int, count: int):
        self.port, self.count = port, count
        self.poll = select.epoll()
        self.open: dict[int, tuple[socket.socket, float]] = {}  # and since when
        self.opened = self.closed = 0
        self.longest_s = 0.0

    def connect(self) -> socket.socket:
        connection = socket.socket()
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SMALL_BUFFER)
        connection.settimeout(10)
        connection.connect(("127.0.0.1", self.port))
        connection.setblocking(False)
        return connection

    def hold_one_more(self) -> None:
        connection = self.connect()
        self.greet(connection, self.opened)
        self.open[connection.fileno()] = (connection, time.monotonic())
        self.poll.register(connection.fileno(), select.EPOLLIN | select.EPOLLRDHUP if self.reads else select.EPOLLRDHUP)
        self.opened += 1

    def note_end(self, number: int) -> None:
        connection, since = self.open.pop(number)
        self.longest_s = max(self.longest_s, time.monotonic() - since)
        self.closed += 1
        self.poll.unregister(number)
        connection.close()

    def run(self) -> None:
        told = 0.0
        while not select.select([sys.stdin], [], [], 0)[0]:
            for _ in range(min(200, self.count - len(self.open))):
                self.hold_one_more()
            for number, _ in self.poll.poll(0.05, 1000):
                if self.ended(number):
                    self.note_end(number)
            self.give()
            if time.monotonic() - told >= 1:
                told = time.monotonic()
                self.tell()
        self.tell()

    def tell(self) -> None:
        print(json.dumps({"held": len(self.open), "opened": self.opened, "closed_by_the_daemon": self.closed,
                          "longest_s": round(self.longest_s, 2)}), flush=True)

    def give(self) -> None:
        pass


class Senders(Holders):
    """Whatever comes back is read: it is they who are slow."""

    reads = True

    def __init__(self, port: int, count: int, seconds_per_byte: float = 10):
        super().__init__(port, count)
        self.period = seconds_per_byte
        self.given: dict[int, tuple[int, float]] = {}  # bytes, and when the next one is due

    def greet(self, connection: socket.socket, _: int) -> None:
        connection.send(REQUEST[:1])
        self.given[connection.fileno()] = (1, time.monotonic() + self.period)

    def ended(self, number: int) -> bool:
        try:
            return not self.open[number][0].recv(4096)
        except BlockingIOError:
            return False
        except OSError:
            return True

    def give(self) -> None:
        now = time.monotonic()
        for number, (connection, _) in self.open.items():
            sent, due = self.given[number]
            if now >= due:
                with contextlib.suppress(OSError):
                    connection.send(REQUEST[sent:sent + 1])
                self.given[number] = (sent + 1, now + self.period)


class Readers(Holders):
    reads = False

    def greet(self, connection: socket.socket, number: int) -> None:
        connection.send(EVENTS if number % 2 else CLOUD)

    def ended(self, number: int) -> bool:
        return True  # the only thing that is looked for


if __name__ == "__main__":
    port, kind, count = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    (Senders(port, count, *map(float, sys.argv[4:])) if kind == "senders" else Readers(port, count)).run()
