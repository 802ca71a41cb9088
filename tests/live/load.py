#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""What watching costs: CPU time of the daemon and its sensor processes for 1, 2, 4 and 8 sensors at 30 Hz.

The simulated sensors replay rendered frames meanwhile, so that the simulator's rendering, which runs in the sensor
processes, does not count.   usage: load.py [SECONDS] [SENSORS...]
"""

import json
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "e2e"))
from cell import BUILD, SOURCE, Daemon, Simulator, call, wait_until  # noqa: E402

TICKS = os.sysconf("SC_CLK_TCK")


def world_of(sensors: int, folder: Path) -> Path:
    world = json.loads((SOURCE / "config/demo_cell/world.json").read_text())
    first = world["sensors"][0]
    x, y, z = first["position_m"]
    world["sensors"] = [{**first, "id": f"eye{i}", "position_m": [x - 0.05 * i, y - 0.2 * i, z + 0.03 * i]}
                        for i in range(sensors)]
    world["motion"] = {"mode": "run", "seed": 11, "count": 12, "speed_rad_s": 2.0, "hold_s": 0.8}
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


def family(pid: int) -> list[int]:
    children = [int(word) for task in Path(f"/proc/{pid}/task").iterdir() for word in (task / "children").read_text().split()]
    return [pid, *children]


def cpu_s(pids: list[int]) -> list[float]:
    def of(pid: int) -> float:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / TICKS
    return [of(pid) for pid in pids]


def drift(daemon: Daemon, sensor: str) -> dict:
    return daemon.json(f"/api/v1/sensors/{sensor}/drift")


def calibrate(daemon: Daemon, sensors: list[str]) -> None:
    jobs = []
    for sensor in sensors:
        answer = call(daemon.port, "POST", f"/api/v1/sensors/{sensor}/calibrations", {"postures": 3})
        jobs.append(answer.headers["Location"])
    for job in jobs:
        ended = daemon.wait_calibration(job)
        if ended["status"] != "succeeded":
            raise SystemExit(f"load: a sensor could not be calibrated: {ended['message']}")
    for sensor in sensors:
        wait_until(f"{sensor} is watched", lambda: drift(daemon, sensor)["verdict"] == "in_place")


def measure(count: int, seconds: float) -> None:
    sensors = [f"eye{i}" for i in range(count)]
    with tempfile.TemporaryDirectory(prefix="calibrd-load-") as name:
        folder = Path(name)
        simulator = Simulator(folder, world=world_of(count, folder))
        daemon = Daemon(folder, simulator.controller_port, simulator.world_file, config=config_of(count, folder), of_demo=False)
        try:
            daemon.wait_ready(60)
            calibrate(daemon, sensors)
            simulator.tell("PUT", "/motion", mode="hold")
            for sensor in sensors:
                simulator.tell("PUT", f"/sensors/{sensor}/mode", mode="replay")
            time.sleep(4)  # every frame of the second is rendered
            pids = family(daemon.process.pid)
            frames = [daemon.json(f"/api/v1/sensors/{sensor}")["frames"] for sensor in sensors]
            before, begin = cpu_s(pids), time.monotonic()
            time.sleep(seconds)
            spent = [b - a for a, b in zip(before, cpu_s(pids))]
            passed = time.monotonic() - begin
            rate = [(daemon.json(f"/api/v1/sensors/{s}")["frames"] - f) / passed for s, f in zip(sensors, frames)]
            verdicts = sorted({drift(daemon, sensor)["verdict"] for sensor in sensors})
            print(json.dumps({"sensors": count, "frames_per_s": round(min(rate), 1), "daemon_percent": round(100 * spent[0] / passed, 1),
                              "sensor_processes_percent": round(100 * sum(spent[1:]) / passed, 1),
                              "percent_per_sensor": round(100 * sum(spent) / passed / count, 2), "verdicts": verdicts}), flush=True)
        finally:
            daemon.stop()
            simulator.stop()


if __name__ == "__main__":
    duration = float(sys.argv[1]) if len(sys.argv) > 1 else 20
    for wanted in [int(word) for word in sys.argv[2:]] or [1, 2, 4, 8]:
        measure(wanted, duration)
