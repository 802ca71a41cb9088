#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Frames and joints in step, over real links: what is out of step gives no view, and nothing old gets a new stamp."""

import os
import signal
import time
import unittest
from pathlib import Path

from cell import SENSOR, SLOWNESS, CellTest, Daemon, Simulator, wait_until

CLOUD = f"/api/v1/sensors/{SENSOR}/clouds/residual"


def processes_of(daemon: Daemon) -> list[int]:
    """The daemon and its sensor processes."""
    ids = [daemon.process.pid]
    for children in Path(f"/proc/{daemon.process.pid}/task").glob("*/children"):
        ids += map(int, children.read_text().split())
    return ids


class InStep(CellTest):
    def refused(self, daemon: Daemon, code: str) -> int:
        return daemon.sensor()["views"]["frames_refused"].get(code, 0)

    def cloud_is_true(self, daemon: Daemon, simulator: Simulator, tolerance_rad: float) -> bool:
        """Whether a cloud was served; fails when its joints are not those of the moment it states. The depth is judged
        by test_a_stopped_process: it fits the joints."""
        answer = daemon.get(CLOUD)
        if answer.status != 200:
            return False
        stamp = int(answer.headers["Calibrd-Joint-Stamp-Ns"])
        shown = [float(q) for q in answer.headers["Calibrd-Joint-Positions"].split()]
        # The simulated controller's joints are 10 ms old when they are sent.
        truth = simulator.truth(stamp - 10_000_000)["joints_reported_rad"]
        off = max(abs(a - b) for a, b in zip(shown, truth))
        self.assertLess(off, tolerance_rad, f"at {stamp}: shown {shown}, truly {truth}")
        return True

    def test_frozen_joints_give_no_view_and_the_api_says_so(self):
        simulator = self.simulate()
        simulator.tell("PUT", "/motion", mode="run", seed=3, count=12, speed_rad_s=0.5, hold_s=1.0)
        daemon = self.serve(simulator).wait_ready()
        wait_until("views come", lambda: daemon.sensor()["views"]["views"] > 0)
        simulator.tell("PUT", "/motion", mode="jog", speed_rad_s=0.3)
        wait_until("the robot moves", lambda: daemon.robot()["controller"]["in_motion"])
        simulator.controller_mode("frozen")
        wait_until("they are found frozen", lambda: self.refused(daemon, "joints_frozen") > 0, 5)
        views = daemon.sensor()["views"]
        print(views)
        self.assertIn("repeat", views["reason"])
        self.assertTrue(daemon.robot()["joints"]["frozen"])
        simulator.tell("PUT", "/motion", mode="hold")
        wait_until("the robot stands", lambda: not daemon.robot()["controller"]["in_motion"])
        before = daemon.sensor()["views"]["views"]
        time.sleep(2)  # the time in which a view would come
        self.assertEqual(daemon.sensor()["views"]["views"], before)
        simulator.controller_mode("normal")
        simulator.tell("PUT", "/motion", mode="run", seed=3, count=12, speed_rad_s=0.5, hold_s=1.0)
        wait_until("views come again", lambda: daemon.sensor()["views"]["views"] > before)

    def test_joints_that_stop_beside_a_living_status_are_named(self):
        simulator = self.simulate()
        daemon = self.serve(simulator).wait_ready()
        simulator.controller_mode("status_only")
        wait_until("it is said", lambda: daemon.sensor()["views"]["code"] == "joints_frozen")

    def test_a_stopped_process_shows_nothing_old_as_new(self):
        simulator = self.simulate()
        simulator.hurry()
        daemon = self.serve(simulator).wait_ready()
        self.assertEqual(daemon.calibrate(postures=3)["status"], "succeeded")
        simulator.tell("PUT", "/motion", mode="jog", speed_rad_s=0.2)
        wait_until("a cloud is true", lambda: self.cloud_is_true(daemon, simulator, 0.02))
        for seconds in (0.7, 1.5, 10):
            stopped = processes_of(daemon)
            self.assertGreater(len(stopped), 1)
            for process in stopped:
                os.kill(process, signal.SIGSTOP)
            time.sleep(seconds)
            for process in stopped:
                os.kill(process, signal.SIGCONT)
            deadline, served = time.monotonic() + 4, 0
            while time.monotonic() < deadline or not served:
                served += self.cloud_is_true(daemon, simulator, 0.02)
                self.assert_depth_fits(daemon)
            print(f"stopped for {seconds} s: {served} clouds after it, all of them true")

    def assert_depth_fits(self, daemon: Daemon):
        """Of frames whose joints are those of another moment most of the robot is elsewhere."""
        answer = daemon.get(CLOUD)
        if answer.status == 200:
            share = share_within(answer.body, 0.02)
            self.assertGreater(share, 0.6, answer.headers["Calibrd-Frame-Stamp-Ns"])


def share_within(ply: bytes, tolerance_m: float) -> float:
    """Of the points of a residual cloud."""
    import struct  # only here

    header, body = ply.split(b"end_header\n", 1)
    count = next(int(line.split()[2]) for line in header.decode().splitlines() if line.startswith("element vertex"))
    size = len(body) // count
    residuals = [struct.unpack_from("<f", body, i * size + 12)[0] for i in range(0, count, 5)]
    return sum(abs(r) < tolerance_m for r in residuals) / max(1, len(residuals))


class TimeOffset(CellTest):
    def test_it_is_estimated_and_applied(self):
        simulator = self.simulate()
        simulator.tell("PUT", f"/sensors/{SENSOR}/errors", latency_s=0.08)
        simulator.controller_mode("normal")
        simulator.tell("PUT", "/controller", latency_s=0.03)
        # Frames that are passed on 80 ms late come at 10 Hz: five of each posture need their time.
        simulator.tell("PUT", "/motion", mode="run", seed=11, count=12, speed_rad_s=2.0, hold_s=1.4)
        # Of the links' difference, 50 ms, the configuration knows 10.
        daemon = self.serve(simulator, "robot.link.latency=20ms", f"sensors.{SENSOR}.latency=30ms").wait_ready()
        offset = daemon.sensor()["time_offset"]
        self.assertFalse(offset["applied"])
        self.assertIn("calibrat", offset["reason"])
        self.assertEqual(daemon.calibrate(postures=4)["status"], "succeeded")
        simulator.tell("PUT", "/motion", mode="run", seed=5, count=12, speed_rad_s=0.6, hold_s=0.3)
        found = wait_until("it is applied", timeout_s=90, condition=lambda: (
            offset if (offset := daemon.sensor()["time_offset"])["applied"] else None))
        print(found)
        self.assertAlmostEqual(found["value_s"], 0.04, delta=0.008 * SLOWNESS)
        self.assertEqual(found["source"], "estimated")


if __name__ == "__main__":
    unittest.main(verbosity=2)
