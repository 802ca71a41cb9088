#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""What watching costs: CPU time and memory of the daemon and its sensor processes for 1, 2, 4 and 8 sensors at 30 Hz.

The simulator's driver runs in the sensor processes, on a thread of its own, whose time is told apart. Its frames are rendered
beforehand: the sensors replay one second, and the robot goes to and fro in one second, so that frames and joints stay in step.
`moving`: so; `still`: the robot holds, and the pose is checked against it every second.

usage: load.py [SECONDS [SENSORS...]]     default: 20 s each of 1 2 4 8 sensors"""

import collections
import json
import os
import sys
import time
from pathlib import Path

from live import WORKING, drift, machine, say, scratch, table  # first: it knows where cell is
from cell import BUILD, SOURCE, Daemon, Simulator, call, wait_until

TICKS = os.sysconf("SC_CLK_TCK")
DRIVER = "sim-render"  # the simulated driver's thread
#: To and fro within one second: 1.875 * 0.2 rad / 1 rad/s + 0.125 s each way. The frames replayed are of one second.
TO_AND_FRO = {"mode": "postures", "speed_rad_s": 1.0, "hold_s": 0.125}
FARTHEST_RAD = 0.2


def world_of(sensors: int, folder: Path) -> Path:
    world = json.loads((SOURCE / "config/demo_cell/world.json").read_text())
    first = world["sensors"][0]
    x, y, z = first["position_m"]
    world["sensors"] = [{**first, "id": f"eye{i}", "position_m": [x - 0.05 * i, y - 0.2 * i, z + 0.03 * i]}
                        for i in range(sensors)]
    world["motion"] = WORKING
    path = folder / "world.json"
    path.write_text(json.dumps(world))
    return path


def config_of(sensors: int, folder: Path) -> Path:
    camera = "fx = 365.6\nfy = 365.6\ncx = 254.9\ncy = 205.4\ndistortion = [0.0905, -0.268, 0.0, 0.0, 0.0951]\n"
    text = '[robot]\nurdf = ""\ncontroller_frame = "base"\nhost = "127.0.0.1"\nlink.latency = "10ms"\n'
    for i in range(sensors):
        text += (f'[sensors.eye{i}]\nuri = "calibrd-sim://{i}"\nlatency = "20ms"\n{camera}'
                 f'driver_directory = "{BUILD}/lib/calibrd-sim-openni"\n')
    path = folder / "cell.toml"
    path.write_text(text)
    return path


def threads_of(pid: int) -> list[tuple[str, float]]:
    """Name and CPU time (s) of each thread."""
    threads = []
    for stat in Path(f"/proc/{pid}/task").glob("*/stat"):
        before, fields = stat.read_text().rsplit(")", 1)
        words = fields.split()
        threads.append((before.split("(", 1)[1], (int(words[11]) + int(words[12])) / TICKS))
    return threads


def memory_mb(pid: int) -> float:
    """What it has alone and its share of what it has with others."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1024


class Family:
    """The daemon, its sensor processes and the simulator."""

    def __init__(self, daemon: Daemon, simulator: Simulator):
        self.daemon, self.simulator = daemon.process.pid, simulator.process.pid
        tasks = Path(f"/proc/{self.daemon}/task").glob("*/children")
        self.children = [int(word) for task in tasks for word in task.read_text().split()]

    def cpu_s(self) -> dict[str, float]:
        children = [thread for pid in self.children for thread in threads_of(pid)]
        driver = sum(seconds for name, seconds in children if name == DRIVER)
        return {"daemon": sum(s for _, s in threads_of(self.daemon)), "sensor_processes": sum(s for _, s in children) - driver,
                "simulated_drivers": driver, "simulator": sum(s for _, s in threads_of(self.simulator))}

    def memory_mb(self) -> dict[str, float]:
        return {"daemon_mb": round(memory_mb(self.daemon)), "sensor_processes_mb": round(sum(map(memory_mb, self.children)))}


def calibrate(daemon: Daemon, sensors: list[str]) -> None:
    answer = call(daemon.port, "POST", "/api/v1/cell/calibrations", {"sensors": sensors, "postures": 4}).json()
    if answer["refused"]:
        raise AssertionError(f"a calibration was refused: {answer['refused']}")
    for job in answer["calibrations"]:
        ended = daemon.wait_calibration(job["location"])
        if ended["status"] != "succeeded":
            raise AssertionError(f"a sensor could not be calibrated: {ended['message']}")
    for sensor in sensors:
        wait_until(f"{sensor} is watched", lambda: drift(daemon, sensor)["verdict"] == "in_place")


def replay(simulator: Simulator, sensors: list[str]) -> None:
    """Renders one second of frames, then shows them again and again."""
    for sensor in sensors:
        simulator.tell("PUT", f"/sensors/{sensor}/mode", mode="replay")
    time.sleep(3 + 2 * len(sensors))  # a busy machine needs several rounds for all of them


def go_to_and_fro(simulator: Simulator) -> None:
    here = simulator.truth()["joints_rad"]
    there = [q - FARTHEST_RAD if j < 4 else q for j, q in enumerate(here)]
    simulator.tell("PUT", "/motion", postures_rad=[there, here], **TO_AND_FRO)
    time.sleep(2)


def sensor_reports(daemon: Daemon, sensors: list[str]) -> list[dict]:
    return [daemon.json(f"/api/v1/sensors/{sensor}") for sensor in sensors]


def refused(earlier: list[dict], later: list[dict]) -> dict[str, int]:
    """Why frames gave no view meanwhile; the drift watch looks at those of a moving robot as well."""
    counts: collections.Counter = collections.Counter()
    for report, sign in [*((r, 1) for r in later), *((r, -1) for r in earlier)]:
        for code, count in report["views"]["frames_refused"].items():
            counts[code] += sign * count
    return {code: count for code, count in counts.items() if count}


def measure(simulator: Simulator, daemon: Daemon, sensors: list[str], motion: str, seconds: float) -> dict:
    replay(simulator, sensors)
    family = Family(daemon, simulator)
    earlier, before, begin = sensor_reports(daemon, sensors), family.cpu_s(), time.monotonic()
    time.sleep(seconds)
    after, passed, reports = family.cpu_s(), time.monotonic() - begin, sensor_reports(daemon, sensors)
    rates = [(new["frames"] - old["frames"]) / passed for new, old in zip(reports, earlier)]
    cores = {f"{name}_cores": round((after[name] - before[name]) / passed, 3) for name in after}
    counted = cores["daemon_cores"] + cores["sensor_processes_cores"]
    line = {"sensors": len(sensors), "robot": motion, "least_frames_per_s": round(min(rates), 1), **cores,
            "cores_per_sensor": round(counted / len(sensors), 3), **family.memory_mb(),
            "verdicts": sorted({drift(daemon, sensor)["verdict"] for sensor in sensors}),
            "valid": sum(report["pose"]["valid"] for report in reports),
            "no_view": refused(earlier, reports), "load_average": round(os.getloadavg()[0], 1)}
    for sensor in sensors:
        simulator.tell("PUT", f"/sensors/{sensor}/mode", mode="normal")
    return line


def measure_cell(count: int, seconds: float) -> list[dict]:
    sensors, lines = [f"eye{i}" for i in range(count)], []
    with scratch() as (folder, programs):
        programs.append(simulator := Simulator(folder, world=world_of(count, folder)))
        programs.append(daemon := Daemon(folder, simulator.controller_port, simulator.world_file, config=config_of(count, folder),
                                         of_demo=False))
        calibrate(daemon.wait_ready(60), sensors)
        simulator.tell("PUT", "/motion", mode="hold")
        for motion in ("still", "moving"):
            time.sleep(2)
            if motion == "moving":
                go_to_and_fro(simulator)
            lines.append(measure(simulator, daemon, sensors, motion, seconds))
            say(**lines[-1])
    return lines


def show(lines: list[dict]) -> None:
    keys = ("sensors", "robot", "least_frames_per_s", "daemon_cores", "sensor_processes_cores", "cores_per_sensor",
            "simulated_drivers_cores", "simulator_cores", "daemon_mb", "sensor_processes_mb")
    table([key.replace("_", " ") for key in keys], [[line[key] for key in keys] for line in lines])
    print(machine())


if __name__ == "__main__":
    duration = float(sys.argv[1]) if len(sys.argv) > 1 else 20
    measured = []
    for wanted in [int(word) for word in sys.argv[2:]] or [1, 2, 4, 8]:
        measured += measure_cell(wanted, duration)
    show(measured)
