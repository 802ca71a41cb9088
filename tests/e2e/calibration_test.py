#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The main job, live: from the simulated cell's wires to a pose over HTTP, compared with the truth."""

import unittest

from cell import SENSOR, CellTest, call, wait_until
from poses import difference

MAX_MM, MAX_MRAD = 3.0, 3.0


class Calibration(CellTest):
    def test_an_uncalibrated_sensor_has_no_pose(self):
        simulator = self.simulate()
        daemon = self.serve(simulator).wait_ready()
        pose = daemon.pose()
        self.assertEqual((pose["valid"], pose["state"], pose["last_known"]), (False, "uncalibrated", None))
        self.assertNotIn("T_base_sensor", pose)
        refused = daemon.get(f"/api/v1/sensors/{SENSOR}/pose?format=matrix")
        self.assertEqual((refused.status, refused.json()["code"]), (409, "pose_not_valid"))

    def test_the_pose_is_true_is_kept_over_a_restart_and_falls_when_the_sensor_is_knocked(self):
        simulator = self.simulate()
        simulator.hurry()
        daemon = self.serve(simulator, "pose.max_unverified=8s", "drift.healing=off").wait_ready()
        job = daemon.calibrate()
        self.assertEqual((job["status"], job["verdict"]), ("succeeded", "accepted"), job)
        self.expect_valid_and_true(daemon, simulator)

        daemon.stop()
        daemon = self.serve(simulator, "pose.max_unverified=8s", "drift.healing=off").wait_ready()
        self.expect_valid_and_true(daemon, simulator)

        simulator.tell("POST", f"/sensors/{SENSOR}/knock", shift_m=[0.02, 0.0, 0.01], turn_deg=[0.0, 2.0, 0.0])
        fallen = wait_until("the knocked pose is no longer valid", lambda: (
            pose if not (pose := daemon.pose())["valid"] else None), 30)
        self.assertNotIn("T_base_sensor", fallen)
        self.assertIsNotNone(fallen["last_known"])

        job = daemon.calibrate()
        self.assertEqual((job["status"], job["verdict"]), ("succeeded", "accepted"), job)
        self.expect_valid_and_true(daemon, simulator)

    def expect_valid_and_true(self, daemon, simulator):
        pose = wait_until("the pose is valid", lambda: pose if (pose := daemon.pose())["valid"] else None, 60)
        self.assertEqual(pose["state"], "calibrated")
        mm, mrad = difference(pose["T_base_sensor"], simulator.true_pose())
        print(f"off by {mm:.3f} mm, {mrad:.3f} mrad; says sigma {pose['sigma_position_m'] * 1e3:.3f} mm, "
              f"{pose['sigma_rotation_rad'] * 1e3:.3f} mrad")
        self.assertLess(mm, MAX_MM)
        self.assertLess(mrad, MAX_MRAD)

    def test_a_sensor_that_is_knocked_between_two_postures_gets_no_pose(self):
        simulator = self.simulate()
        simulator.hurry()
        daemon = self.serve(simulator).wait_ready()
        location = daemon.start_calibration(postures=6)
        wait_until("half of the postures are there", lambda: daemon.json(location)["postures_seen"] >= 3, period_s=0.01)
        simulator.tell("POST", f"/sensors/{SENSOR}/knock", shift_m=[0.003, 0.003, 0.003], turn_deg=[0, 0, 0])
        job = daemon.wait_calibration(location)
        self.assertEqual(job["status"], "failed", job)
        self.assertIn("sensor_moved_meanwhile", [reason["code"] for reason in job["result"]["reasons"]], job)
        self.assertNotIn("T_base_sensor", job["result"])
        self.assertEqual(daemon.pose()["state"], "uncalibrated")
        self.assertEqual(daemon.calibrate(postures=6)["status"], "succeeded", "once it stands")

    def test_a_calibration_can_be_cancelled(self):
        simulator = self.simulate()
        daemon = self.serve(simulator).wait_ready()
        location = daemon.start_calibration(postures=50)
        self.assertEqual(call(daemon.port, "DELETE", location).status, 200)
        self.assertEqual(daemon.wait_calibration(location, 10)["status"], "cancelled")


if __name__ == "__main__":
    unittest.main(verbosity=2)
