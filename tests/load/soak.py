#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Hours of everyday work: a sensor at 30 Hz, a controller at 40 Hz, the pose asked for 500 times a second. Does anything grow?

usage: soak.py [HOURS [WARM_UP_HOURS]]     default: 1 h after 0.2 h: some histories hold ten minutes
"""

import os
import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "live"))
from live import machine, say, table, working_cell  # noqa: E402  first: it knows where cell is
from cell import SENSOR  # noqa: E402
from holdings import Holdings  # noqa: E402
import open_loop  # noqa: E402

POSE = f"/api/v1/sensors/{SENSOR}/pose"
RATE_PER_S, CONNECTIONS = 500, 16
LOOK_EVERY_S, TELL_EVERY = 5.0, 24


def slope(points: list[tuple[float, float]]) -> float:
    return statistics.linear_regression(*zip(*points)).slope if len(points) > 2 else 0.0


def watch(pid: int, load, warm_up_s: float) -> list[tuple[float, Holdings]]:
    """Until the load ends; what was seen after the warm-up."""
    begin, seen = time.monotonic(), []
    while load.poll() is None:
        now, passed = Holdings.of(pid), time.monotonic() - begin
        seen.append((passed, now))
        if len(seen) % TELL_EVERY == 1:
            say(hours=round(passed / 3600, 3), **vars(now), load_average=round(os.getloadavg()[0], 1))
        time.sleep(LOOK_EVERY_S)
    return [one for one in seen if one[0] >= warm_up_s]


def frames(daemon) -> int:
    return daemon.sensor()["frames"]


def main(hours: float = 1, warm_up_hours: float = 0.2) -> None:
    with working_cell() as (_, daemon):
        seconds = 3600 * (hours + warm_up_hours)
        began, frames_before = time.monotonic(), frames(daemon)
        load = open_loop.start(daemon.port, POSE, RATE_PER_S, CONNECTIONS, seconds)
        seen = watch(daemon.process.pid, load, 3600 * warm_up_hours)
        passed = time.monotonic() - began
        line = {"hours": hours, "memory_mib_per_hour": round(slope([(t / 3600, h.memory_kib / 1024) for t, h in seen]), 3),
                "memory_mib": [round(f(h.memory_kib for _, h in seen) / 1024, 1) for f in (min, max)],
                "descriptors": [f(h.descriptors for _, h in seen) for f in (min, max)],
                "threads": [f(h.threads for _, h in seen) for f in (min, max)],
                "frames_per_s": round((frames(daemon) - frames_before) / passed, 1),
                "robot_connects": daemon.robot()["link"]["connects"], **open_loop.result(load), "load_average": round(os.getloadavg()[0], 1)}
        say(**line)
    keys = ("hours", "memory_mib_per_hour", "memory_mib", "descriptors", "threads", "frames_per_s", "answers", "p99_ms", "unanswered")
    table([key.replace("_", " ") for key in keys], [[line[key] for key in keys]])
    print(machine())


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
