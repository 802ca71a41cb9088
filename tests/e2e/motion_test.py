#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The daemon moves the simulated robot through the motion port: only when it may, and any doubt stops it."""

import math
import os
import signal
import socket
import time
import unittest

from cell import SENSOR, SLOWNESS, CellTest, call, wait_until

STOP, END_MODE, DISCONNECT, START_MODE, POINT = "200111", "200122", "200130", "200121", "14"
HERE_RAD = [0.3, 0.4, 0.2, 0.8, 0.1, 0.5, 0.0]
TOUR_DEG = [[20, 25, 10, 48, 5, 30, 0], [14, 20, 12, 42, 8, 26, 4], [18, 24, 8, 50, 2, 32, -4]]
FAR_DEG = [[60, 25, 10, 48, 5, 30, 0]]
BELOW_TABLE_DEG = [[20, 105, 0, 60, 0, 60, 0]]


class Motion(CellTest):
    def cell(self, *settings: str):
        """A robot at rest, and a daemon that may move it; those before them end."""
        self.end_programs()
        self.programs.clear()
        simulator = self.simulate()
        simulator.tell("PUT", "/motion", mode="postures", postures_rad=HERE_RAD, speed_rad_s=3)
        wait_until("the robot is there", lambda: self.distance(simulator, HERE_RAD) < 1e-6)
        routes = {"tour": TOUR_DEG, "far": FAR_DEG, "low": BELOW_TABLE_DEG}
        daemon = self.serve(simulator, "motion.enabled=true", f"motion.port={simulator.motion_port}",
                            "motion.max_speed_deg_s=10", "motion.max_acceleration_deg_s2=30", "motion.hold=300ms",
                            *(f"motion.routes.{name}.postures_deg={value}" for name, value in routes.items()), *settings)
        daemon.wait_alive()
        return simulator, daemon

    @staticmethod
    def motion(simulator) -> dict:
        return simulator.truth()["controller"]["motion"]

    @staticmethod
    def distance(simulator, posture_rad) -> float:
        return max(abs(a - b) for a, b in zip(simulator.truth()["joints_rad"], posture_rad))

    def start(self, daemon, **body) -> str:
        wait_until("nothing hinders", lambda: not daemon.json("/api/v1/robot/motions")["hindrance"])
        answer = call(daemon.port, "POST", "/api/v1/robot/motions", body)
        self.assertEqual(answer.status, 202, answer.body)
        return answer.headers["Location"]

    def refused(self, daemon, status: int, code: str, **body) -> dict:
        answer = call(daemon.port, "POST", "/api/v1/robot/motions", body)
        self.assertEqual((answer.status, answer.json()["code"]), (status, code), answer.body)
        self.assertGreater(len(answer.json()["remedy"]), 20)
        return answer.json()

    def wait_ended(self, daemon, location: str, status: str, timeout_s: float = 60.0) -> dict:
        ended = wait_until("the motion ends", lambda: job if (job := daemon.json(location))["finished_at"] else None,
                           timeout_s)
        self.assertEqual(ended["status"], status, ended)
        return ended

    def wait_under_way(self, simulator) -> None:
        wait_until("the robot is well under way", lambda: self.distance(simulator, HERE_RAD) > 0.05)

    def expect_standing(self, simulator) -> None:
        wait_until("the port is closed", lambda: not self.motion(simulator)["client"])
        before = simulator.truth()["joints_rad"]
        time.sleep(0.2)
        self.assertEqual(simulator.truth()["joints_rad"], before)
        self.assertGreater(self.distance(simulator, [math.radians(q) for q in FAR_DEG[0]]), 0.1, "it went all the way")

    def expect_stopped_by_calibrd(self, simulator) -> None:
        self.expect_standing(simulator)
        commands = self.motion(simulator)["commands"]
        for command in (STOP, END_MODE, DISCONNECT):
            self.assertEqual(commands.get(command), 1, commands)

    def test_three_taught_postures_are_visited_at_the_speed_allowed(self):
        simulator, daemon = self.cell()
        location = self.start(daemon, route="tour")
        reached, fastest = set(), 0.0

        def ended():
            nonlocal fastest
            truth = simulator.truth()
            fastest = max(fastest, *(abs(v) for v in truth["motion"]["velocities_rad_s"]))
            for i, posture in enumerate(TOUR_DEG):
                if max(abs(a - math.radians(b)) for a, b in zip(truth["joints_rad"], posture)) < 1e-4:
                    reached.add(i)
            return daemon.json(location)["finished_at"]

        wait_until("the motion ends", ended, 60, period_s=0.02)
        job = self.wait_ended(daemon, location, "succeeded")
        self.assertEqual((job["reached"], reached), (3, {0, 1, 2}))
        self.assertLess(self.distance(simulator, [math.radians(q) for q in TOUR_DEG[-1]]), 1e-4)
        self.assertLessEqual(fastest, math.radians(10))
        self.assertGreater(fastest, math.radians(1))
        motion = self.motion(simulator)
        self.assertEqual((motion["accepted"], motion["client"]), (1, False))
        self.assertEqual((motion["commands"][START_MODE], motion["commands"].get(STOP)), (1, None))
        log = daemon.output()
        self.assertEqual(log.count("trajectory point"), motion["commands"][POINT])
        for said in ("opening the motion port", "check motion ready (200101)", "closing the motion port", "ended"):
            self.assertIn(said, log)
        again = self.start(daemon, route="tour")  # a good end leaves the robot ready for the next motion
        call(daemon.port, "DELETE", again)

    def test_delete_stops_at_once(self):
        simulator, daemon = self.cell()
        location = self.start(daemon, route="far")
        self.wait_under_way(simulator)
        self.refused(daemon, 409, "motion_in_progress", route="tour")
        asked = time.monotonic()
        self.assertEqual(call(daemon.port, "DELETE", location).status, 200)
        self.wait_ended(daemon, location, "stopped", 5)
        self.assertLess(time.monotonic() - asked, 1.0 * SLOWNESS)
        self.expect_stopped_by_calibrd(simulator)
        self.assertEqual(call(daemon.port, "DELETE", location).json()["code"], "motion_ended")
        # A person has to look first: the robot's ROS job is over.
        self.assertIn("ROS job", self.refused(daemon, 409, "motion_not_possible", route="tour")["detail"])
        simulator.tell("PUT", "/controller", motion_possible=True)
        self.start(daemon, route="tour")

    def test_any_doubt_of_the_status_stops_it(self):
        # The next status says so, or the answer to the next point: whichever comes first.
        for doubt, message in (({"e_stopped": True}, "emergency stop"),
                               ({"pendant": "teach"}, "not in automatic|not in PLAY"),
                               ({"motion_possible": False}, "motion is possible|ROS job is not started"),
                               ({"in_error": True}, "alarm"), ({"drives_powered": False}, "drives are off|servos off")):
            with self.subTest(doubt=doubt):
                simulator, daemon = self.cell()
                location = self.start(daemon, route="far")
                self.wait_under_way(simulator)
                simulator.tell("PUT", "/controller", **doubt)
                self.assertRegex(self.wait_ended(daemon, location, "failed", 5)["message"], message)
                self.expect_standing(simulator)
                self.assertEqual(self.motion(simulator)["commands"].get(STOP), 1)
                self.refused(daemon, 409, "motion_not_possible", route="tour")

    def test_a_state_link_that_dies_or_freezes_stops_it(self):
        for mode, message in (("refuse", "link"), ("silent", "sends nothing|no fresh|no joint"),
                              ("status_only", "no joint positions|no fresh joint"), ("frozen", "commanded path")):
            with self.subTest(mode=mode):
                simulator, daemon = self.cell()
                location = self.start(daemon, route="far")
                self.wait_under_way(simulator)
                simulator.controller_mode(mode)
                self.assertRegex(self.wait_ended(daemon, location, "failed", 5)["message"], message)
                self.expect_stopped_by_calibrd(simulator)

    def test_the_end_of_the_daemon_stops_it_kindly_and_its_death_stops_it_too(self):
        for kill in (False, True):
            with self.subTest(kill=kill):
                simulator, daemon = self.cell()
                self.start(daemon, route="far")
                self.wait_under_way(simulator)
                if kill:
                    os.kill(daemon.process.pid, signal.SIGKILL)
                    daemon.process.wait()
                    self.expect_standing(simulator)
                else:
                    self.assertLess(daemon.stop(), 1.5 * SLOWNESS)
                    self.expect_stopped_by_calibrd(simulator)

    def test_another_client_of_the_motion_port_ends_it(self):
        simulator, daemon = self.cell("motion.hold=20s")
        location = self.start(daemon, route="tour")
        wait_until("the first posture is held", lambda: daemon.json(location)["reached"] == 1, 60)
        with socket.create_connection(("127.0.0.1", simulator.motion_port)):
            self.assertIn("another client", self.wait_ended(daemon, location, "failed", 5)["message"])

    def test_what_must_not_be_is_refused_and_the_port_stays_closed(self):
        simulator, daemon = self.cell()
        wait_until("nothing hinders", lambda: not daemon.json("/api/v1/robot/motions")["hindrance"])
        self.assertIn("below the table", self.refused(daemon, 409, "way_refused", route="low")["detail"])
        self.refused(daemon, 404, "no_such_motion_route", route="nowhere")
        self.refused(daemon, 409, "posture_not_suggested", next_posture_of=SENSOR, approve=HERE_RAD)
        self.refused(daemon, 400, "bad_value")
        simulator.tell("PUT", "/motion", mode="jog", speed_rad_s=0.2)
        wait_until("it is seen to move", lambda: "ROS job" in (daemon.json("/api/v1/robot/motions")["hindrance"] or ""))
        self.refused(daemon, 409, "motion_not_possible", route="tour")
        self.assertEqual(self.motion(simulator)["accepted"], 0)

    def test_a_daemon_that_is_not_enabled_never_opens_the_port(self):
        simulator, daemon = self.cell("motion.enabled=false")
        daemon.wait_ready()
        self.refused(daemon, 403, "motion_disabled", route="tour")
        self.refused(daemon, 403, "motion_disabled", next_posture_of=SENSOR, approve=HERE_RAD)
        self.assertFalse(daemon.json("/api/v1/robot/motions")["enabled"])
        call(daemon.port, "DELETE", "/api/v1/robot/motions/m1")
        location = daemon.start_calibration(postures=2)
        time.sleep(2)
        call(daemon.port, "DELETE", location)
        daemon.stop()
        self.assertEqual(self.motion(simulator)["accepted"], 0)

    def test_the_suggested_posture_is_taken_once_it_is_approved(self):
        simulator, daemon = self.cell("motion.max_speed_deg_s=20")
        simulator.tell("PUT", "/motion", mode="run", seed=11, count=12, speed_rad_s=2.0, hold_s=0.8)
        daemon.wait_ready()
        self.assertEqual(daemon.calibrate(postures=3)["status"], "succeeded")
        simulator.tell("PUT", "/motion", mode="postures", postures_rad=HERE_RAD, speed_rad_s=1)
        wait_until("the robot is there", lambda: self.distance(simulator, HERE_RAD) < 1e-6)
        suggestion = daemon.json(f"/api/v1/sensors/{SENSOR}/next-posture")
        other = [q + 0.01 for q in suggestion["positions_rad"]]
        self.refused(daemon, 409, "posture_not_suggested", next_posture_of=SENSOR, approve=other)
        wait_until("nothing hinders", lambda: not daemon.json("/api/v1/robot/motions")["hindrance"])
        answer = call(daemon.port, "POST", "/api/v1/robot/motions", {"next_posture_of": SENSOR, "approve": suggestion})
        if answer.status == 409:  # the straight way there may lead through the table or the robot itself
            self.assertEqual(answer.json()["code"], "way_refused")
            self.skipTest(answer.json()["detail"])
        self.assertEqual(answer.status, 202, answer.body)
        self.wait_ended(daemon, answer.headers["Location"], "succeeded", 120)
        self.assertLess(self.distance(simulator, suggestion["positions_rad"]), 1e-3)


if __name__ == "__main__":
    unittest.main(verbosity=2)
