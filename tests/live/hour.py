#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""False alarms of the whole path: a live sensor that nobody moves, watched for an hour while everything else happens. The robot
works and pauses, people walk by, boxes are pushed, carried across the bench, taken away and brought back, the sensor warms up.
JSON lines, one a minute, then a table.      usage: hour.py [HOURS [SEED]] [--require]"""

import collections
import math
import random
import sys
import time

from live import SENSOR, drift, known, machine, say, table, working_cell
from poses import difference

AT_WORK = {"mode": "run", "count": 12, "speed_rad_s": 1.0, "hold_s": 1.0}
PERIOD_S, LINE_S = 0.2, 60.0
CARRY_S, CARRY_STEPS = 4.0, 40
WARM_M, WARM_TIME_S = 0.004, 900.0  # the range creeps by so much, with this time constant
BOXES = ("box_red", "box_blue", "box_tall")
TRUE_MM, TRUE_MRAD = 3.0, 3.0


class Cell:
    """What goes on in the cell: generators that do a little and say how long (s) until they go on."""

    def __init__(self, simulator, seed: int):
        self.simulator, self.source = simulator, random.Random(seed)
        self.counts: collections.Counter[str] = collections.Counter()
        sensor = next(s for s in simulator.truth()["sensors"] if s["id"] == SENSOR)
        self.offset_m = sensor["depth_errors"]["offset_m"]
        self.shifts_m = {box: [0.0, 0.0] for box in BOXES}

    def people(self):
        while True:
            yield self.source.uniform(5, 25)
            x = self.source.choice((self.source.uniform(-1.2, 0.0), self.source.uniform(0.5, 1.1)))
            self.simulator.tell("PUT", "/person", present=True, from_m=[x, -1.6], to_m=[x, 1.6],
                                speed_m_s=self.source.uniform(0.4, 1.4))
            self.counts["people"] += 1
            yield self.source.uniform(3, 15)
            self.simulator.tell("PUT", "/person", present=False)

    def boxes(self):
        while True:
            yield self.source.uniform(10, 40)
            box = self.source.choice(BOXES)
            what = self.source.choice((self.push, self.carry, self.take))
            self.counts[what.__name__] += 1
            yield from what(box)

    def place(self, box: str, to_m: list[float]) -> None:
        by = [b - a for a, b in zip(self.shifts_m[box], to_m)]
        self.simulator.tell("PUT", f"/objects/{box}", shift_m=[*by, 0])
        self.shifts_m[box] = to_m

    def new_place(self) -> list[float]:
        return [self.source.uniform(-0.15, 0.15), self.source.uniform(-0.15, 0.15)]

    def push(self, box: str):
        self.place(box, self.new_place())
        yield 0

    def carry(self, box: str):
        """Somebody carries it around for a while and puts it down elsewhere."""
        start, end = self.shifts_m[box], self.new_place()
        for step in range(1, CARRY_STEPS + 1):
            share = step / CARRY_STEPS
            bow = 0.25 * math.sin(math.pi * share)
            self.place(box, [a + share * (b - a) + bow for a, b in zip(start, end)])
            yield CARRY_S / CARRY_STEPS

    def take(self, box: str):
        self.simulator.tell("PUT", f"/objects/{box}", present=False)
        yield self.source.uniform(5, 90)
        self.simulator.tell("PUT", f"/objects/{box}", present=True)

    def robot(self):
        while True:
            yield self.source.uniform(40, 120)
            self.simulator.tell("PUT", "/motion", mode="hold")
            self.counts["pauses"] += 1
            yield self.source.uniform(5, 30)
            self.simulator.tell("PUT", "/motion", mode="resume")

    def warmth(self):
        begin = time.monotonic()
        while True:
            off = WARM_M * (1 - math.exp(-(time.monotonic() - begin) / WARM_TIME_S))
            self.simulator.tell("PUT", f"/sensors/{SENSOR}/errors", depth={"offset_m": self.offset_m + off})
            yield 5


class Watch:
    """What the daemon said all the while."""

    def __init__(self, simulator, daemon):
        self.simulator, self.daemon = simulator, daemon
        self.seconds: dict[str, float] = collections.defaultdict(float)
        self.alarms: collections.Counter[str] = collections.Counter()  # times that a verdict came
        self.last, self.last_s = "", time.monotonic()
        self.begin_s, self.invalid_s, self.worst_mm, self.worst_mrad, self.most = self.last_s, 0.0, 0.0, 0.0, 0.0
        self.calibrations: set[str] = set()

    def look(self) -> None:
        said, pose, now = drift(self.daemon), self.daemon.pose(), time.monotonic()
        passed, self.last_s = now - self.last_s, now
        self.seconds[said["verdict"]] += passed
        self.alarms[said["verdict"]] += said["verdict"] != self.last
        self.last = said["verdict"]
        if said["watched"]:
            self.most = max(self.most, said["statistic"] / said["threshold"])
        self.invalid_s += passed * (not pose["valid"])
        self.calibrations.add(known(pose)["calibration"])
        if pose["valid"]:
            mm, mrad = difference(pose["T_base_sensor"], self.simulator.true_pose())
            self.worst_mm, self.worst_mrad = max(self.worst_mm, mm), max(self.worst_mrad, mrad)

    def line(self, counts) -> dict:
        return {"minutes": round((self.last_s - self.begin_s) / 60, 1), "sensor_moved": self.alarms["sensor_moved"],
                "robot_model_wrong": self.alarms["robot_model_wrong"], "most_of_threshold": round(self.most, 3),
                "invalid_s": round(self.invalid_s, 1), "worst_mm": round(self.worst_mm, 2),
                "worst_mrad": round(self.worst_mrad, 2), "poses": len(self.calibrations),
                "seconds": {v: round(s, 1) for v, s in self.seconds.items()}, "staged": dict(counts)}


def run(simulator, daemon, hours: float, seed: int) -> Watch:
    cell, watch = Cell(simulator, seed), Watch(simulator, daemon)
    acts = [[0.0, act] for act in (cell.people(), cell.boxes(), cell.robot(), cell.warmth())]
    end, next_line = watch.begin_s + 3600 * hours, watch.begin_s + LINE_S
    while time.monotonic() < end:
        for act in acts:
            if time.monotonic() >= act[0]:
                act[0] = time.monotonic() + next(act[1])
        watch.look()
        if time.monotonic() >= next_line:
            say(**watch.line(cell.counts))
            next_line += LINE_S
        time.sleep(PERIOD_S)
    say(**watch.line(cell.counts))
    return watch


def main() -> None:
    numbers = [word for word in sys.argv[1:] if not word.startswith("--")]
    hours = float(numbers[0]) if numbers else 1.0
    seed = int(numbers[1]) if len(numbers) > 1 else 1
    with working_cell(motion=AT_WORK | {"seed": 20 + seed}) as (simulator, daemon):
        watch = run(simulator, daemon, hours, seed)
        log = [line for line in daemon.output().splitlines() if "warning" in line or "error" in line]
    table(["verdict", "times", "seconds"],
          [[v, watch.alarms[v], f"{s:.1f}"] for v, s in sorted(watch.seconds.items(), key=lambda each: -each[1])])
    print(f"{hours:g} h of a sensor that stands: called moved {watch.alarms['sensor_moved']} times; statistic at most "
          f"{watch.most:.2f} of the threshold; pose not valid for {watch.invalid_s:.1f} s, at worst {watch.worst_mm:.2f} mm, "
          f"{watch.worst_mrad:.2f} mrad off; {len(watch.calibrations)} pose(s) served; {machine()}")
    wrong = watch.worst_mm > TRUE_MM or watch.worst_mrad > TRUE_MRAD
    print(f"a pose served as valid though off by more than {TRUE_MM:.0f} mm or mrad: {'yes' if wrong else 'never'}")
    print("\n".join(log[-20:]))
    if "--require" in sys.argv and (wrong or watch.alarms["sensor_moved"] > 0):
        sys.exit(1)


if __name__ == "__main__":
    main()
