#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""While the robot moves, the virtual cloud is where the robot truly is at the cloud's stamp: the cloud is where forward
kinematics puts the reported joints, and these are the simulator's joints of that moment.

The simulator's truth is exact at any moment. A stamp is not: messages take some 0.05 ms to be sent and received, more on a
busy machine. At 0.5 rad/s and a metre each 0.2 ms is 0.1 mm; so one cloud in two may be farther off the truth than that, and
each is held to it in time.
"""

import random
import statistics
import struct
import threading
import time
import unittest

from cell import SENSOR, URDF, CellTest, wait_until
from poses import Robot, Surface, apply, inverse, read_stl

SPEED_RAD_S = 0.5
MAX_M = 1e-4
MAX_S, MEDIAN_S = 10e-3, 2e-3  # of stamps
CLOUDS, POINTS = 5, 300


def read_ply(data: bytes) -> list[tuple[float, float, float]]:
    """Points of a binary PLY file with x, y, z as its first and only properties."""
    header, _, body = data.partition(b"end_header\n")
    count = next(int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element vertex"))
    return [struct.unpack_from("<3f", body, 12 * i) for i in range(count)]


class JointRecorder(threading.Thread):
    """Reads /api/v1/robot as fast as it answers: joint positions by their stamp."""

    def __init__(self, daemon):
        super().__init__(daemon=True)
        self.cell, self.positions, self.running = daemon, {}, True

    def run(self):
        while self.running:
            joints = self.cell.robot()["joints"]
            self.positions[joints["stamp_ns"]] = joints["positions_rad"]
            time.sleep(0.005)


class VirtualCloud(CellTest):
    def setUp(self):
        super().setUp()
        self.robot = Robot(URDF)
        self.surfaces = {link: Surface(read_stl(path)) for link, path in self.robot.meshes.items()}

    def farthest_from_robot(self, points, joints: dict[str, float]) -> float:
        to_link = {link: inverse(T) for link, T in self.robot.link_poses(joints).items() if link in self.surfaces}
        return max(min(self.surfaces[link].distance(apply(T, p)) for link, T in to_link.items()) for p in points)

    def test_it_equals_forward_kinematics_at_its_stamp(self):
        simulator = self.simulate()
        guess = [n for row in simulator.true_pose() for n in row]  # a virtual cloud needs a pose to look from
        daemon = self.serve(simulator, f"sensors.{SENSOR}.guess={guess}").wait_ready()
        simulator.tell("PUT", "/motion", mode="jog", joint="joint_s", speed_rad_s=SPEED_RAD_S)
        wait_until("the robot moves", lambda: max(map(abs, simulator.truth()["motion"]["velocities_rad_s"])) > 0.49)
        names = daemon.robot()["joint_names"]
        recorder = JointRecorder(daemon)
        recorder.start()
        clouds = [self.take_cloud(daemon) for _ in range(CLOUDS)]
        time.sleep(0.2)  # let the recorder pass the last stamp
        recorder.running = False
        recorder.join()

        choose, seen, late_s, off_truth = random.Random(1), 0, [], []
        for stamp_ns, stated, points in clouds:
            recorded = recorder.positions.get(stamp_ns)
            if recorded is not None:
                seen += 1
                self.assertLess(max(abs(a - b) for a, b in zip(recorded, stated)), 1e-9)
            sample, truth = choose.sample(points, POINTS), simulator.truth(stamp_ns)
            off = self.farthest_from_robot(sample, dict(zip(names, stated)))
            print(f"joints of {stamp_ns} ns: farthest of {POINTS} points {off * 1e3:.4f} mm from the robot")
            self.assertLess(off, MAX_M)
            off_truth.append(self.farthest_from_robot(
                sample, dict(zip(truth["joint_names"], truth["joints_reported_rad"]))))
            late_s.append(self.lateness_s(truth, stated))
            print(f"against the truth: {off_truth[-1] * 1e3:.4f} mm, stamp {late_s[-1] * 1e3:+.3f} ms late")
        self.assertLess(statistics.median(off_truth), MAX_M, off_truth)
        self.assertLess(max(map(abs, late_s)), MAX_S, late_s)
        self.assertLess(abs(statistics.median(late_s)), MEDIAN_S, late_s)
        self.assertGreater(seen, 0, "no cloud carries a stamp that /api/v1/robot has shown")
        turned = abs(clouds[-1][1][0] - clouds[0][1][0])
        self.assertGreater(turned, 1e-3, "the robot stood still")

    def lateness_s(self, truth, stated) -> float:
        """By how much the stamp is later than the moment the robot truly was at the stated joints."""
        speed = truth["motion"]["velocities_rad_s"][0]
        self.assertGreater(abs(speed), 0.1, "the joint is turning round: its place tells no time")
        return (truth["joints_reported_rad"][0] - stated[0]) / speed

    def take_cloud(self, daemon):
        answer = daemon.get(f"/api/v1/sensors/{SENSOR}/clouds/virtual?frame=base")
        self.assertEqual(answer.status, 200, answer.body[:500])
        positions = [float(word) for word in answer.headers["Calibrd-Joint-Positions"].split()]
        points = read_ply(answer.body)
        self.assertGreater(len(points), 1000)
        time.sleep(0.1)
        return int(answer.headers["Calibrd-Joint-Stamp-Ns"]), positions, points


if __name__ == "__main__":
    unittest.main(verbosity=2)
