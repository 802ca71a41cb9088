#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""For how long a pose is served as valid after its sensor was moved a little: pure slides and pure turns, which things in view
show worse than a knock that does both. Real daemon, real links; the robot at work, and standing in one posture.

By turns a slide in a direction drawn at random, one along the wall (which few things show) and a turn, of 3 to 6 mm or mrad.
The sensor is watched for 10 s, then put back, and its calibration activated again. JSON lines, then a table.

usage: slides.py [MOVES [SEED]] [--require]      default: 24 moves; --require: exit status 1 when a wrong pose was served for
                                                 longer than 1.5 s in all"""

import math
import random
import statistics
import sys
import time

from healing import direction
from live import SENSOR, WORKING, call, drift, known, machine, say, settle, table, working_cell
from poses import difference

WATCHED_S, PERIOD_S, MOST_S = 10.0, 0.03, 1.5
WRONG_MM, WRONG_MRAD = 3.0, 3.0
KNOCK = f"/sensors/{SENSOR}/knock"
KINDS = ("slide", "slide along the wall", "turn")
ALONG_WALL = (0.0, 1.0, 0.0)


def move_of(source: random.Random, kind: str) -> dict:
    far = 1e-3 * source.uniform(3.2, 6)
    if kind == "turn":
        return {"shift_m": [0, 0, 0], "turn_deg": [math.degrees(far * c) for c in direction(source)]}
    way = direction(source) if kind == "slide" else [source.choice((-1, 1)) * c for c in ALONG_WALL]
    return {"shift_m": [far * c for c in way], "turn_deg": [0, 0, 0]}


def back_from(move: dict) -> dict:
    return {name: [-c for c in vector] for name, vector in move.items()}


def watch(simulator, daemon) -> dict:
    """What is served after the move."""
    begin = last = time.monotonic()
    wrong_s, flips, was_valid, doubted_s, drifted_s = 0.0, 0, True, None, None
    while last - begin < WATCHED_S:
        pose = daemon.pose()
        now = time.monotonic()
        mm, mrad = difference(known(pose)["T_base_sensor"], simulator.true_pose())
        wrong_s += (now - last) * (pose["valid"] and (mm > WRONG_MM or mrad > WRONG_MRAD))
        flips += pose["valid"] != was_valid
        was_valid, last = pose["valid"], now
        if not was_valid and doubted_s is None:
            doubted_s = round(now - begin, 2)
        if pose["state"] == "drifted" and drifted_s is None:
            drifted_s = round(now - begin, 2)
        time.sleep(PERIOD_S)
    return {"mm": round(mm, 2), "mrad": round(mrad, 2), "served_s": round(wrong_s, 2), "flips": flips, "doubted_s": doubted_s,
            "drifted_s": drifted_s, "verdict": drift(daemon)["verdict"], "state": pose["state"]}


def go_back(simulator, daemon, move: dict, calibration: str) -> None:
    simulator.tell("POST", KNOCK, **back_from(move))
    simulator.tell("PUT", "/motion", **WORKING)
    call(daemon.port, "POST", f"/api/v1/calibrations/{calibration}/activate", {})
    settle(daemon)
    time.sleep(1)


def run(moves: int, seed: int) -> list[dict]:
    source, lines = random.Random(seed), []
    with working_cell("drift.healing=off", motion=WORKING | {"seed": seed}) as (simulator, daemon):
        calibration = daemon.pose()["calibration"]
        for number in range(moves):
            kind, is_still = KINDS[number % len(KINDS)], number // len(KINDS) % 2 == 1
            if is_still:
                simulator.tell("PUT", "/motion", mode="hold")
                time.sleep(1.5)
            move = move_of(source, kind)
            simulator.tell("POST", KNOCK, **move)
            lines.append({"kind": kind, "robot": "stands" if is_still else "works", **watch(simulator, daemon)})
            say(**lines[-1])
            go_back(simulator, daemon, move, calibration)
    return lines


def show(lines: list[dict]) -> bool:
    rows = []
    for robot in ("works", "stands"):
        for kind in KINDS:
            these = [line for line in lines if (line["robot"], line["kind"]) == (robot, kind)]
            # A move that leaves the pose off by less than that is none that must be found.
            these = [line for line in these if line["mm"] > WRONG_MM or line["mrad"] > WRONG_MRAD]
            if these:
                served = [line["served_s"] for line in these]
                rows.append([f"robot {robot}", kind, len(these), f"{statistics.median(served):.2f}", f"{max(served):.2f}",
                             sum(line["drifted_s"] is not None for line in these), max(line["flips"] for line in these)])
    table(["", "moved", "events", "wrong pose served, median s", "at most s", "told to be drifted", "changes of validity"], rows)
    print(machine())
    return all(line["served_s"] <= MOST_S for line in lines)


def main() -> None:
    numbers = [int(word) for word in sys.argv[1:] if word.isdigit()]
    is_well = show(run(numbers[0] if numbers else 24, numbers[1] if len(numbers) > 1 else 1))
    sys.exit(1 if "--require" in sys.argv and not is_well else 0)


if __name__ == "__main__":
    main()
