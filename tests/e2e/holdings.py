# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""What a process holds, and a connection that is asked again and again."""

import contextlib
import http.client
import json
import os
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Holdings:
    descriptors: int
    threads: int
    memory_kib: int  # its own: neither files nor what it shares with others

    @staticmethod
    def of(pid: int) -> "Holdings":
        status = dict(line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
        return Holdings(len(os.listdir(f"/proc/{pid}/fd")), int(status["Threads"]), int(status["RssAnon"].split()[0]))

    def minus(self, earlier: "Holdings") -> dict[str, int]:
        return {"descriptors": self.descriptors - earlier.descriptors, "threads": self.threads - earlier.threads,
                "memory_kib": self.memory_kib - earlier.memory_kib}


def children_of(pid: int) -> list[int]:
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            found += map(int, task.read_text().split())
    return found


class Asking:
    """One connection, kept; made anew when the daemon has closed it. For one thread."""

    def __init__(self, port: int):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)

    def answer(self, path: str) -> tuple[int, http.client.HTTPMessage, bytes]:
        for attempt in (1, 2):
            try:
                self.connection.request("GET", path)
                response = self.connection.getresponse()
                return response.status, response.headers, response.read()
            except (OSError, http.client.HTTPException):
                self.connection.close()
                if attempt == 2:
                    raise
        raise AssertionError("not reached")

    def json(self, path: str) -> dict:
        return json.loads(self.answer(path)[2])

    def close(self) -> None:
        self.connection.close()
