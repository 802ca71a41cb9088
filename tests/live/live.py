# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""What the figures of the live cell have in common: a calibrated cell at work, tables, and how busy the machine was."""

import contextlib
import json
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "e2e"))
from cell import SENSOR, Daemon, Simulator, call, wait_until  # noqa: E402, F401

#: Minutes at a real cell are shortened: the robot hurries from posture to posture and stays 0.8 s at each.
WORKING = {"mode": "run", "seed": 11, "count": 12, "speed_rad_s": 2.0, "hold_s": 0.8}


def say(**line) -> None:
    print(json.dumps(line), flush=True)


def machine() -> str:
    return f"{os.cpu_count()} cores, shared with the simulator; load average {os.getloadavg()[0]:.1f}"


def table(head: list[str], rows: list[list]) -> None:
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")


def drift(daemon: Daemon, sensor: str = SENSOR) -> dict:
    return daemon.json(f"/api/v1/sensors/{sensor}/drift")


def wait_verdict(daemon: Daemon, verdict: str, timeout_s: float = 60.0) -> dict:
    return wait_until(f"the verdict {verdict}", lambda: d if (d := drift(daemon))["verdict"] == verdict else None,
                      timeout_s)


def known(pose: dict) -> dict:
    """What is known of the pose, valid or not: calibration, T_base_sensor, sigmas."""
    return pose if pose["valid"] else pose["last_known"] or {}


def settle(daemon: Daemon, timeout_s: float = 90.0) -> None:
    """Waits until the pose is served and the watch says that the sensor stands."""
    wait_until("the pose is valid", lambda: daemon.pose()["valid"], timeout_s)
    wait_verdict(daemon, "in_place", timeout_s)


@contextlib.contextmanager
def scratch():
    """A folder and the list of programs that run in it: stopped at the end, their logs' ends shown when something goes wrong."""
    with tempfile.TemporaryDirectory(prefix="calibrd-live-") as name:
        programs = []
        try:
            yield Path(name), programs
        except BaseException:
            print("".join(f"--- end of the log of {p.name}\n{p.output()[-4000:]}" for p in programs), file=sys.stderr)
            raise
        finally:
            for program in reversed(programs):
                program.stop()


@contextlib.contextmanager
def working_cell(*settings: str, postures: int = 6, motion: dict = WORKING):
    """A simulator and a daemon, calibrated, the robot at work."""
    with scratch() as (folder, programs):
        programs.append(simulator := Simulator(folder))
        simulator.tell("PUT", "/motion", **motion)
        programs.append(daemon := Daemon(folder, simulator.controller_port, simulator.world_file, *settings))
        job = daemon.wait_ready(60).calibrate(postures=postures)
        if job["status"] != "succeeded":
            raise AssertionError(f"the cell could not be calibrated: {job['message']}")
        settle(daemon)
        time.sleep(3)  # what stands around is learnt from the frames of this time as well
        yield simulator, daemon
