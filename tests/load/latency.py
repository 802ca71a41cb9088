#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""How long GET pose takes at a fixed rate, measured from when each request was meant to leave, while the cell is watched
and calibrated again and again.

usage: latency.py [SECONDS [RATE_PER_S]]     default: 60 s at 500/s over 16 connections
"""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "live"))
from live import machine, say, table, working_cell  # noqa: E402  first: it knows where cell is
from cell import SENSOR  # noqa: E402
import open_loop  # noqa: E402

POSE = f"/api/v1/sensors/{SENSOR}/pose"
CONNECTIONS = 16


def calibrate_until_it_ends(daemon, load) -> list[str]:
    verdicts = []
    while load.poll() is None:
        verdicts.append(daemon.calibrate(postures=2)["verdict"])
    return verdicts


def measure(daemon, seconds: float, rate: float, calibrating: bool) -> dict:
    load = open_loop.start(daemon.port, POSE, rate, CONNECTIONS, seconds)
    verdicts = calibrate_until_it_ends(daemon, load) if calibrating else []
    return {"calibrating": calibrating, "rate_per_s": rate, "seconds": seconds, **open_loop.result(load),
            "calibrations": len(verdicts), "load_average": round(os.getloadavg()[0], 1)}


def main(seconds: float = 60, rate: float = 500) -> None:
    with working_cell() as (_, daemon):
        lines = []
        for calibrating in (False, True):
            lines.append(measure(daemon, seconds, rate, calibrating))
            say(**lines[-1])
    keys = ("calibrating", "answers", "median_ms", "p99_ms", "p999_ms", "most_ms", "unanswered", "calibrations")
    table([key.replace("_", " ") for key in keys], [[line[key] for key in keys] for line in lines])
    print(machine())


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
