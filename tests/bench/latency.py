#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""How well the daemon finds a time offset that the simulator injects over the real links, and how fast; and a
calibration from views of the moving robot beside one from still views. JSON lines.

usage: latency.py [INJECTED_MS ...]       default: 0 30 80; CALIBRD_BUILD names the build"""

import json
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "e2e"))
from cell import SENSOR, Daemon, Simulator, wait_until  # noqa: E402
from poses import difference  # noqa: E402

# Both links are this late in any case: earlier, a busy machine is still rendering the picture.
BASE_S = 0.08
WATCHED_S = 30
WORKING = dict(mode="run", seed=5, count=12, speed_rad_s=0.5, hold_s=0.5)


def inject(simulator: Simulator, seconds: float):
    simulator.tell("PUT", f"/sensors/{SENSOR}/errors", latency_s=BASE_S + seconds)
    simulator.tell("PUT", "/controller", latency_s=BASE_S)


def watch(daemon: Daemon, injected_s: float) -> dict:
    """From the first check that makes the pose valid on."""
    wait_until("the pose is checked", lambda: daemon.pose()["valid"], 60)
    begun = time.monotonic()
    first = wait_until("the offset is applied", timeout_s=180, condition=lambda: (
        offset if (offset := daemon.sensor()["time_offset"])["applied"] else None))
    applied_s = time.monotonic() - begun
    time.sleep(max(0.0, WATCHED_S - applied_s))
    last = daemon.sensor()["time_offset"]
    return {"injected_ms": 1e3 * injected_s, "applied_after_s": round(applied_s, 1),
            "error_when_applied_ms": round(1e3 * (first["value_s"] - injected_s), 2),
            f"error_after_{WATCHED_S}_s_ms": round(1e3 * (last["value_s"] - injected_s), 2),
            "sigma_ms": round(1e3 * last["sigma_s"], 2), "jitter_ms": round(1e3 * last["jitter_s"], 2)}


def calibrate(simulator: Simulator, daemon: Daemon, what: str) -> dict:
    before = daemon.sensor()["views"]["moving_views"]
    job = daemon.calibrate(postures=10)
    line = {"calibration": what, "verdict": job["verdict"],
            "moving_frames": daemon.sensor()["views"]["moving_views"] - before}
    if pose := (job["result"] or {}).get("T_base_sensor"):
        line["mm"], line["mrad"] = (round(float(e), 3) for e in difference(pose, simulator.true_pose()))
    return line


def main(injected_ms: list[float]):
    with tempfile.TemporaryDirectory(prefix="calibrd-latency-") as name:
        folder = Path(name)
        programs = [Simulator(folder)]
        try:
            run(programs, folder, injected_ms)
        finally:
            for program in reversed(programs):
                program.stop()


def run(programs: list, folder: Path, injected_ms: list[float]):
    simulator = programs[0]
    settings = ("robot.link.latency=0s", f"sensors.{SENSOR}.latency=0s", "calibration.frames_per_posture=1", "calibration.views=still_or_timed")

    def serve(*more: str) -> Daemon:
        programs.append(Daemon(folder, simulator.controller_port, simulator.world_file, *settings, *more))
        return programs[-1].wait_ready()

    inject(simulator, 0)
    simulator.hurry()
    daemon = serve()
    print(json.dumps(calibrate(simulator, daemon, "still")), flush=True)
    for milliseconds in injected_ms:
        programs.pop().stop()
        inject(simulator, milliseconds / 1e3)
        simulator.tell("PUT", "/motion", **WORKING)
        daemon = serve()
        print(json.dumps(watch(daemon, milliseconds / 1e3)), flush=True)
    simulator.tell("PUT", "/motion", mode="run", seed=5, count=12, speed_rad_s=0.25, hold_s=0)
    print(json.dumps(calibrate(simulator, daemon, f"moving, {injected_ms[-1]:.0f} ms injected")), flush=True)


if __name__ == "__main__":
    main([float(word) for word in sys.argv[1:]] or [0.0, 30.0, 80.0])
