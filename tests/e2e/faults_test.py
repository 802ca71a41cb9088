#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Robot and sensor come, go and come back; the daemon lives, says what is wrong, and takes them up again."""

import re
import unittest

from cell import SENSOR, CellTest, free_port, wait_until


class Faults(CellTest):
    def expect_dependency(self, daemon, name: str, ready: bool, timeout_s: float = 45.0) -> dict:
        """Waits for the state of one dependency; what is not ready must say why and what to do. The time allows for
        the 30 s that the robot link stays away after two quick evictions."""
        def find():
            listed = daemon.get("/readyz?verbose").json()["dependencies"]
            found = next(d for d in listed if d["name"] == name)
            return found if found["ready"] == ready else None

        found = wait_until(f"{name} is {'ready' if ready else 'not ready'}", find, timeout_s)
        if not ready:
            self.assertGreater(len(found["reason"] or ""), 20, found)
            print(f"{name}: {found['state']}: {found['reason']}")
        self.assertEqual(daemon.get("/livez").status, 200)
        return found

    def expect_robot(self, daemon, ready: bool) -> dict:
        return self.expect_dependency(daemon, "robot", ready)

    def expect_sensor(self, daemon, ready: bool) -> dict:
        return self.expect_dependency(daemon, f"sensor {SENSOR}", ready)

    def test_the_daemon_may_start_before_robot_and_sensor(self):
        port, world = free_port(), self.folder / "world"
        daemon = self.serve_at(port, world).wait_alive()
        self.expect_robot(daemon, False)
        self.expect_sensor(daemon, False)
        self.simulate(port)
        daemon.wait_ready()

    def test_the_sensor_may_come_after_the_robot(self):
        simulator = self.simulate()
        simulator.sensor_mode("unplugged")
        daemon = self.serve(simulator).wait_alive()
        self.expect_robot(daemon, True)
        self.expect_sensor(daemon, False)
        simulator.sensor_mode("normal")
        daemon.wait_ready()

    def test_the_robot_may_come_after_the_sensor(self):
        simulator = self.simulate()
        simulator.controller_mode("refuse")
        daemon = self.serve(simulator).wait_alive()
        self.expect_sensor(daemon, True)
        self.expect_robot(daemon, False)
        simulator.controller_mode("normal")
        daemon.wait_ready()

    def test_a_restart_of_the_whole_cell_is_survived(self):
        simulator = self.simulate()
        daemon = self.serve(simulator).wait_ready()
        simulator.stop()
        self.expect_robot(daemon, False)
        self.expect_sensor(daemon, False)
        self.simulate(simulator.controller_port)
        daemon.wait_ready()

    def test_a_sensor_unplugged_and_plugged_in_again_streams_again(self):
        simulator = self.simulate()
        daemon = self.serve(simulator).wait_ready()
        for _ in range(2):
            simulator.sensor_mode("unplugged")
            self.expect_sensor(daemon, False)
            simulator.sensor_mode("normal")
            self.expect_sensor(daemon, True)

    def test_a_sensor_unplugged_while_it_is_calibrated_starts_over_and_the_job_says_so(self):
        simulator = self.simulate()
        simulator.hurry()
        daemon = self.serve(simulator).wait_ready()
        location = daemon.start_calibration(postures=50)
        wait_until("a posture is seen", lambda: daemon.json(location)["postures_seen"] > 0)
        progress = daemon.json(location)["progress"]
        simulator.sensor_mode("unplugged")
        self.expect_sensor(daemon, False)
        job = wait_until("it starts over", lambda: job if (job := daemon.json(location))["postures_seen"] == 0 else None)
        print(job["message"])
        self.assertEqual(job["status"], "collecting")
        self.assertGreaterEqual(job["progress"], progress)
        self.assertIn("dropped", job["message"])
        self.assertIn("the sensor is lost", job["message"])
        simulator.sensor_mode("normal")
        wait_until("postures are seen again", lambda: daemon.json(location)["postures_seen"] > 0)

    def test_a_driver_that_hangs_or_crashes_costs_a_restart_of_the_sensor_process(self):
        simulator = self.simulate()
        daemon = self.serve(simulator).wait_ready()
        before = daemon.sensor()["restarts"]
        simulator.tell("POST", f"/sensors/{SENSOR}/crash")
        wait_until("the sensor process is started anew", lambda: daemon.sensor()["restarts"] > before)
        self.expect_sensor(daemon, True)
        simulator.sensor_mode("hanging")
        self.expect_sensor(daemon, False)
        simulator.sensor_mode("normal")
        self.expect_sensor(daemon, True)

    def test_a_robot_that_is_silent_blind_or_cut_off_is_noticed_and_taken_up_again(self):
        simulator = self.simulate()
        daemon = self.serve(simulator).wait_ready()
        for mode in ("silent", "status_only", "refuse"):
            simulator.controller_mode(mode)
            self.expect_robot(daemon, False)
            wait_until("its joints are stale", lambda: daemon.robot()["joints"]["stale"])
            simulator.controller_mode("normal")
            self.expect_robot(daemon, True)
        simulator.tell("POST", "/controller/drop", how="reset")
        wait_until("it connects again", lambda: daemon.robot()["link"]["connects"] >= 2)
        self.expect_robot(daemon, True)

    def test_the_wrong_byte_order_is_named(self):
        daemon = self.serve(self.simulate(), "robot.byte_order=little").wait_alive()
        # Until the first frame is in, the reason is that the link is being made.
        wait_until("the byte order is named", lambda: self.names_byte_order(self.expect_robot(daemon, False)))

    @staticmethod
    def names_byte_order(robot: dict) -> bool:
        return bool(re.search("byte.order|big", robot["reason"]))

    def test_a_calibration_without_a_robot_fails_and_says_why(self):
        simulator = self.simulate()
        simulator.controller_mode("refuse")
        daemon = self.serve(simulator, "calibration.collect_timeout=2s").wait_alive()
        self.expect_sensor(daemon, True)
        job = daemon.calibrate()
        self.assertEqual(job["status"], "failed")
        self.assertGreater(len(job["message"]), 20)
        print(job["message"])

    def serve_at(self, controller_port, world):
        class Absent:  # where a simulator will be
            pass
        absent = Absent()
        absent.controller_port, absent.world_file = controller_port, world
        return self.serve(absent)


if __name__ == "__main__":
    unittest.main(verbosity=2)
