#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""What is staged before a live sensor against what the daemon's drift watch says of it, over the real links, the robot at work.

A verdict is judged as scripts/watch.sh does it: that the sensor has moved, if it was ever said; else what is right, if it was
shown for 2 s; else what was shown for longest besides `in_place`. 12 s for each event, 30 s for joint zeros. JSON lines, then
a table.      usage: events.py [--rounds N] [--seed S] [--event VERDICT] [--knocks-first] [--require]"""

import argparse
import collections
import math
import random
import statistics
import sys
import time

from healing import direction
from live import SENSOR, WORKING, drift, known, machine, say, settle, table, wait_until, working_cell
from poses import difference

VERDICTS = ("in_place", "sensor_moved", "something_in_front", "scene_changed", "robot_model_wrong", "depth_bias_changed",
            "no_evidence")
WATCHED_S, TWO_POSTURES_S, QUIET_S = 12, 30, 2
LASTING_S, LEAST_S, PERIOD_S = 2.0, 0.3, 0.03
TRUE_MM, TRUE_MRAD = 3.0, 3.0
UNSEEN_S = 4.0  # for so long nobody sees the sensor that was knocked
LEAST_RIGHT = 0.95
ERRORS, MODE = f"/sensors/{SENSOR}/errors", f"/sensors/{SENSOR}/mode"


class Stage:
    """One event: what it is called, what is right to say, how it is staged and taken back."""

    def __init__(self, right: str, what: str, calls: list, back: list, creeping=None, later=()):
        self.right, self.what, self.calls, self.back = right, what, calls, back
        self.creeping = creeping  # called again and again with the seconds since the beginning
        self.later = later  # calls after UNSEEN_S

    def watched_s(self) -> int:
        return TWO_POSTURES_S if self.right == "robot_model_wrong" else WATCHED_S


def knock(source: random.Random, mm: float, mrad: float) -> Stage:
    shift = [1e-3 * mm * c for c in direction(source)]
    turn = [math.degrees(1e-3 * mrad) * c for c in direction(source)]
    path = f"/sensors/{SENSOR}/knock"
    back = [("POST", path, {"shift_m": [-c for c in shift], "turn_deg": [-c for c in turn]})]
    return Stage("sensor_moved", f"knock of {mm:.1f} mm, {mrad:.1f} mrad", [("POST", path, {"shift_m": shift, "turn_deg": turn})], back)


def person(source: random.Random, low: float, high: float) -> Stage:
    x = source.uniform(low, high)
    way = {"present": True, "from_m": [x, -1.6], "to_m": [x, 1.6], "speed_m_s": source.uniform(0.5, 1.2)}
    return Stage("something_in_front", f"a person walks at x = {x:.2f} m", [("PUT", "/person", way)],
                 [("PUT", "/person", {"present": False})])


def box(source: random.Random, name: str, taken: bool) -> Stage:
    angle, far = source.uniform(0, 2 * math.pi), source.uniform(0.1, 0.2)
    shift = [far * math.cos(angle), far * math.sin(angle), 0]
    change = {"present": False} if taken else {"shift_m": shift}
    back = {"present": True} if taken else {"shift_m": [-c for c in shift]}
    what = f"{name} {'taken away' if taken else f'moved by {1e3 * far:.0f} mm'}"
    return Stage("scene_changed", what, [("PUT", f"/objects/{name}", change)], [("PUT", f"/objects/{name}", back)])


def robot_brought() -> Stage:
    there = {"present": True, "position_m": [-0.7, 0.45, 0], "posture_rad": [0, 0.5, 0, 0.5, 0, 0.5, 0]}
    return Stage("scene_changed", "another robot brought", [("PUT", "/other-robot", there)], [("PUT", "/other-robot", {"present": False})])


def joint_zero(source: random.Random) -> Stage:
    joint, off = source.randrange(4), source.choice((-1, 1)) * source.uniform(0.010, 0.030)
    zeros = [off if j == joint else 0.0 for j in range(7)]
    return Stage("robot_model_wrong", f"zero of joint {joint + 1} off by {1e3 * off:+.0f} mrad",
                 [("PUT", "/joint-zeros", {"joint_zero_rad": zeros})], [("PUT", "/joint-zeros", {"joint_zero_rad": [0.0] * 7})])


def range_errors(simulator) -> dict:
    return next(s for s in simulator.truth()["sensors"] if s["id"] == SENSOR)["depth_errors"]


def range_off(source: random.Random, usual: dict, creeps: bool) -> Stage:
    off = source.choice((-1, 1)) * source.uniform(0.005, 0.015)
    def at(share):
        return ("PUT", ERRORS, {"depth": {"offset_m": usual["offset_m"] + share * off}})
    back = [at(0)]
    if creeps:  # as while it warms up, but in 6 s
        return Stage("depth_bias_changed", f"range creeps by {1e3 * off:+.1f} mm", [], back, lambda t: at(min(1, t / 6)))
    return Stage("depth_bias_changed", f"range jumps by {1e3 * off:+.1f} mm", [at(1)], back)


def dark(usual: dict) -> Stage:
    return Stage("no_evidence", "dark: no pixel has a depth", [("PUT", ERRORS, {"depth": {"dropout": 1}})],
                 [("PUT", ERRORS, {"depth": {"dropout": usual["dropout"]}})])


def no_frames() -> Stage:
    return Stage("no_evidence", "frames stop", [("PUT", MODE, {"mode": "silent"})], [("PUT", MODE, {"mode": "normal"})])


def unseen_knocks(source: random.Random, usual: dict) -> list[Stage]:
    """The sensor is moved while it sees nothing, or sends nothing."""
    hidden = {"in the dark": ((ERRORS, {"depth": {"dropout": 1}}), (ERRORS, {"depth": {"dropout": usual["dropout"]}})),
              "while frames stop": ((MODE, {"mode": "silent"}), (MODE, {"mode": "normal"})),
              "while its driver hangs": ((MODE, {"mode": "hanging"}), (MODE, {"mode": "normal"}))}
    stages = []
    for what, (hide, show) in hidden.items():
        stage = knock(source, source.uniform(8, 30), source.uniform(8, 30))
        stages.append(Stage(stage.right, f"{stage.what}, {what}", [("PUT", *hide), *stage.calls],
                            [("PUT", *show), *stage.back], later=[("PUT", *show)]))
    return stages


def stages_of(source: random.Random, usual: dict, knocks_first: bool) -> list[Stage]:
    boxes = ["box_blue", "box_tall", "box_red"]
    source.shuffle(boxes)
    knocks = [knock(source, source.uniform(3, 5), source.uniform(3, 5)),
              knock(source, source.uniform(6, 15), source.uniform(5, 20)), knock(source, 30, 52)]
    others = [Stage("in_place", "nothing", [], []), person(source, 0.6, 1.0), person(source, -1.2, 0.0),
              box(source, boxes[0], False), box(source, boxes[1], True), robot_brought(), joint_zero(source), joint_zero(source),
              range_off(source, usual, False), range_off(source, usual, True), dark(usual), no_frames()]
    knocks += unseen_knocks(source, usual)
    return knocks + others if knocks_first else others + knocks


def tell(simulator, calls) -> None:
    for method, path, body in calls:
        simulator.tell(method, path, **body)


class Listener:
    """For how long each verdict was shown, when the right one came, and poses that were served though wrong."""

    def __init__(self, simulator, daemon, stage: Stage):
        self.simulator, self.daemon, self.stage = simulator, daemon, stage
        self.seconds: dict[str, float] = collections.defaultdict(float)
        self.first_s = math.nan
        self.valid_s, self.wrong = 0.0, 0

    def listen(self, seconds: float, staged: bool) -> None:
        begin = last = time.monotonic()
        later = list(self.stage.later) if staged else []
        while last - begin < seconds:
            if later and last - begin >= UNSEEN_S:
                tell(self.simulator, later)
                later = []
            if staged and self.stage.creeping:
                tell(self.simulator, [self.stage.creeping(last - begin)])
            verdict = drift(self.daemon)["verdict"]
            now = time.monotonic()
            self.seconds[verdict] += now - last
            if verdict == self.stage.right and math.isnan(self.first_s):
                self.first_s = now - begin
            self.look_at_pose(now - begin, now - last)
            last = now
            time.sleep(PERIOD_S)

    def look_at_pose(self, after_s: float, passed_s: float) -> None:
        pose = self.daemon.pose()
        self.valid_s += passed_s * pose["valid"]
        if pose["valid"] and after_s > 1:  # a knock needs its moment to be found
            mm, mrad = difference(pose["T_base_sensor"], self.simulator.true_pose())
            self.wrong += mm > TRUE_MM or mrad > TRUE_MRAD

    def told(self) -> str:
        right, others = self.stage.right, {v: s for v, s in self.seconds.items() if v != "in_place" and s >= LEAST_S}
        if "sensor_moved" in self.seconds:
            return "sensor_moved"
        if right != "in_place" and self.seconds.get(right, 0) >= LASTING_S:
            return right
        return max(others, key=others.get, default="in_place")


def recover(simulator, daemon, stage: Stage) -> str:
    """Back to a sensor that stands with a true pose; says what was needed for it besides waiting."""
    if stage.right != "sensor_moved":
        tell(simulator, stage.back)
    begin, needed = time.monotonic(), ""
    try:
        settle(daemon, 40)
    except AssertionError:
        needed = "calibrated by hand"
    if not needed and not is_true(simulator, daemon):
        needed = "calibrated by hand: the pose served is wrong"
    if needed:
        wait_until("it can be calibrated", lambda: not daemon.pose()["job"], 120)
        daemon.calibrate(postures=6)
        settle(daemon)
    return f"{needed or 'alone'}, {time.monotonic() - begin:.0f} s"


def is_true(simulator, daemon) -> bool:
    mm, mrad = difference(known(daemon.pose())["T_base_sensor"], simulator.true_pose())
    return mm <= TRUE_MM and mrad <= TRUE_MRAD


def pose_of(simulator, daemon) -> dict:
    """How true the pose is that the sensor is watched from."""
    pose = daemon.pose()
    found = known(pose)
    mm, mrad = difference(found["T_base_sensor"], simulator.true_pose())
    return {"valid": pose["valid"], "mm": round(mm, 2), "mrad": round(mrad, 2),
            "sigma_mm": round(1e3 * found["sigma_position_m"], 2), "sigma_mrad": round(1e3 * found["sigma_rotation_rad"], 2)}


def run_event(simulator, daemon, stage: Stage) -> dict:
    quiet = Listener(simulator, daemon, Stage("in_place", "", [], []))
    quiet.listen(QUIET_S, False)
    listener, pose = Listener(simulator, daemon, stage), pose_of(simulator, daemon)
    tell(simulator, stage.calls)
    listener.listen(stage.watched_s(), True)
    last = drift(daemon)
    return {"event": stage.right, "what": stage.what, "verdict": listener.told(), "before": quiet.told(),
            "first_s": round(listener.first_s, 2), "seconds": {v: round(s, 1) for v, s in listener.seconds.items()},
            "pose_before": pose, "pose_valid_s": round(listener.valid_s, 1),
            "pose_wrong_though_valid": listener.wrong, "statistic": round(last["statistic"], 2),
            "depth_offset_change_mm": round(1e3 * last["depth_offset_change_m"], 2), "background": last["background"],
            "recovered": recover(simulator, daemon, stage)}


def show(lines: list[dict]) -> bool:
    """Whether all is as it must be."""
    counts = collections.Counter((line["event"], line["verdict"]) for line in lines)
    rows = []
    for event in VERDICTS:
        these = [line for line in lines if line["event"] == event]
        if these:
            first = [line["first_s"] for line in these if not math.isnan(line["first_s"])]
            rows.append([event, *(counts[event, said] or "" for said in VERDICTS),
                         f"{statistics.median(first):.2f}" if first else "never"])
    table(["staged \\ said", *VERDICTS, "first said after, median s"], rows)
    right = sum(line["event"] == line["verdict"] for line in lines)
    wrong = sum(line["pose_wrong_though_valid"] > 0 for line in lines)
    print(f"right: {right} of {len(lines)}; events with a pose served as valid, later than 1 s, though off by more than "
          f"{TRUE_MM:.0f} mm or mrad: {wrong}; {machine()}")
    false = [line for line in lines if line["event"] != "robot_model_wrong" and "robot_model_wrong" in line["seconds"]]
    print(f"`robot_model_wrong` shown though nothing was wrong with it, besides the verdict: {len(false)} events, "
          f"{sum(line['seconds']['robot_model_wrong'] for line in false):.1f} s")
    for line in lines:
        if line["event"] != line["verdict"] or line in false:
            print(f"  {line['what']}: {line['verdict']} {line['seconds']}, pose before {line['pose_before']}")
    missed = [line for line in lines if line["event"] == "sensor_moved" and line["verdict"] != "sensor_moved"]
    return right >= LEAST_RIGHT * len(lines) and not missed and not wrong


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=1, help="events of every kind as often as that")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--event", choices=VERDICTS, help="those alone")
    parser.add_argument("--knocks-first", action="store_true",
                        help="the other events are then seen from a pose that a healing has found, and from its background")
    parser.add_argument("--require", action="store_true", help="exit status 1 unless all is as it must be")
    options = parser.parse_args()
    lines = []
    for number in range(options.rounds):
        seed = options.seed + number
        with working_cell(motion=WORKING | {"seed": 10 + seed}) as (simulator, daemon):
            for stage in stages_of(random.Random(seed), range_errors(simulator), options.knocks_first):
                if options.event in (None, stage.right):
                    lines.append({"seed": seed} | run_event(simulator, daemon, stage))
                    say(**lines[-1])
    is_well = show(lines)
    sys.exit(0 if is_well or not options.require else 1)


if __name__ == "__main__":
    main()
