#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Each controller of config/examples: the file is a good configuration, and the daemon that runs with it reads the
simulated controller of that make: joints as they truly are, at rest and on the move, and again after a drop."""

import json
import subprocess
import tomllib
import unittest
from pathlib import Path
from typing import NamedTuple

from cell import BIN, OF_THIS_BUILD, SENSOR, SIX_AXES, SOURCE, URDF, CellTest, Daemon, Simulator, wait_until
from poses import difference

EXAMPLES = SOURCE / "config/examples"
MAX_MM, MAX_MRAD = 5, 5
STILL = 1e-6  # rad: floats on the wire
ON_THE_MOVE = 0.03  # rad: 0.5 rad/s, stamped within a few ms on a busy machine


class Make(NamedTuple):
    """How the simulated controller of a make behaves; `robot` is of its number of axes."""

    robot: Path
    controller: dict
    second_robot: bool = False


ROS_INDUSTRIAL = {"protocol": "joint_position", "send_velocity": False}
MAKES = {
    "yaskawa_fs100": Make(URDF, {"protocol": "motoros", "byte_order": "big"}),
    "yaskawa_yrc1000_second_robot": Make(SIX_AXES, {"protocol": "motoros", "byte_order": "little", "groups": 2}, True),
    "fanuc": Make(SIX_AXES, {**ROS_INDUSTRIAL, "byte_order": "big", "status_every": 11, "send_bytes": 4,
                             "j3_from_horizontal": True}),
    "abb_irc5": Make(SIX_AXES, {**ROS_INDUSTRIAL, "byte_order": "little", "rate_hz": 10}),
    "universal_robots": Make(SIX_AXES, {"protocol": "rtde", "rtde_texts": True}),
}
SENSOR_OF_THE_DEMO = tuple(f"sensors.{SENSOR}.{key}={value}" for key, value in tomllib.loads(
    (SOURCE / "config/demo.toml").read_text())["sensors"][SENSOR].items() if not isinstance(value, str))


class Controllers(CellTest):
    def simulate_make(self, name: str) -> Simulator:
        make = MAKES[name]
        world = json.loads((SOURCE / "config/demo_cell/world.json").read_text())
        world["robot"].pop("posture_rad")
        world["controller"] = {**make.controller, "latency_s": 0.01}
        (self.folder / "world.json").write_text(json.dumps(world))
        self.programs.append(Simulator(self.folder, world=self.folder / "world.json", urdf=make.robot))
        return self.programs[-1]

    def serve_example(self, name: str, simulator: Simulator, *settings: str) -> Daemon:
        own = ("robot.host=127.0.0.1", f"robot.urdf={MAKES[name].robot}", "robot.link.latency=10ms",
               "robot.link.eviction_pause=100ms",  # the tests drop the link more often than a controller would
               f"robot.search_paths=['{MAKES[name].robot.parents[2]}']", *SENSOR_OF_THE_DEMO,
               f"sensors.{SENSOR}.latency=20ms")
        self.programs.append(Daemon(self.folder, simulator.controller_port, simulator.world_file, *own, *settings,
                                    config=EXAMPLES / f"{name}.toml"))
        return self.programs[-1].wait_alive()

    @staticmethod
    def wait_streaming(daemon: Daemon) -> dict:
        return wait_until("joints come", lambda: (robot := daemon.robot())["link"]["state"] == "streaming" and robot)

    @staticmethod
    def wait_status(daemon: Daemon):
        """FANUC's first one comes after the joints."""
        wait_until("the status is fresh", lambda: (status := daemon.robot()["controller"]) and status["fresh"])

    def expect_true_joints(self, name: str, daemon: Daemon, simulator: Simulator, tolerance_rad: float):
        joints = self.wait_streaming(daemon)["joints"]
        truth = simulator.truth(joints["stamp_ns"])
        wanted = truth["other_robot"]["joints_rad"] if MAKES[name].second_robot else truth["joints_reported_rad"]
        self.assertEqual(len(joints["positions_rad"]), len(wanted))
        for got, want in zip(joints["positions_rad"], wanted):
            self.assertAlmostEqual(got, want, delta=tolerance_rad)

    def hold(self, daemon: Daemon, simulator: Simulator):
        """At rest, and the daemon has joints from after the stop; their stamps may be late by what a busy machine takes."""
        at_rest_ns = simulator.tell("PUT", "/motion", mode="hold")["from_ns"] + 200_000_000
        wait_until("the robot is at rest", lambda: daemon.robot()["joints"]["stamp_ns"] > at_rest_ns)

    def run_make(self, name: str, *settings: str) -> tuple[Daemon, Simulator]:
        simulator = self.simulate_make(name)
        if MAKES[name].second_robot:
            simulator.tell("PUT", "/other-robot", posture_rad=[-0.1, 0.2, -0.3, 0.4, -0.5, 0.6])
        daemon = self.serve_example(name, simulator, *settings)
        self.wait_streaming(daemon)
        for _ in range(5):
            self.expect_true_joints(name, daemon, simulator, ON_THE_MOVE)
        self.hold(daemon, simulator)
        self.expect_true_joints(name, daemon, simulator, STILL)
        self.wait_status(daemon)
        simulator.tell("POST", "/controller/drop", how="reset")
        wait_until("it connects again", lambda: daemon.robot()["link"]["connects"] >= 2)
        self.expect_true_joints(name, daemon, simulator, STILL)
        self.assertEqual(daemon.robot()["link"]["framing_errors"], 0)
        return daemon, simulator

    def test_every_example_is_a_good_configuration(self):
        self.assertEqual({path.stem for path in EXAMPLES.glob("*.toml")}, set(MAKES), "an example without a test")
        for name, make in MAKES.items():
            ended = subprocess.run(
                [BIN / "calibrd", "serve", "--config", EXAMPLES / f"{name}.toml", "--check-config", "--set",
                 f"robot.urdf={make.robot}", "--set", f"robot.search_paths=['{make.robot.parents[2]}']"],
                capture_output=True, text=True, timeout=20, check=False)
            with self.subTest(name):
                self.assertEqual(ended.returncode, 0, ended.stderr)
                self.assertIn("the configuration is good", ended.stdout)

    def test_yaskawa_fs100(self):
        self.run_make("yaskawa_fs100")

    def test_yaskawa_second_robot(self):
        self.run_make("yaskawa_yrc1000_second_robot")

    def test_fanuc(self):
        daemon, _ = self.run_make("fanuc")
        self.wait_status(daemon)
        first = daemon.robot()["joints"]["sequence"]

        def stays_fresh() -> bool:
            robot = daemon.robot()
            self.assertTrue(robot["controller"]["fresh"], "the status comes in every 11th message only")
            return robot["joints"]["sequence"] > first + 40

        wait_until("a second of joints", stays_fresh)

    def test_abb(self):
        self.run_make("abb_irc5")

    def test_universal_robots(self):
        daemon, simulator = self.run_make("universal_robots")
        controller = daemon.robot()["controller"]
        self.assertEqual((controller["drives_powered"], controller["motion_possible"]), (True, True))
        simulator.tell("PUT", "/controller", e_stopped=True)
        wait_until("the emergency stop is seen", lambda: daemon.robot()["controller"]["e_stopped"])
        wait_until("no power on the arm is the reason", lambda: "power" in (daemon.robot()["link"]["reason"] or ""))
        simulator.tell("PUT", "/controller", e_stopped=False, rtde_protocol=1)
        simulator.tell("POST", "/controller/drop", how="fin")
        self.expect_true_joints("universal_robots", daemon, simulator, STILL)
        simulator.controller_mode("frozen")
        wait_until("a frozen controller is noticed", lambda: daemon.robot()["link"]["state"] == "joints_stale")

    def test_a_cell_is_calibrated_with_the_joints_of_rtde(self):
        simulator = self.simulate_make("universal_robots")
        simulator.hurry()
        daemon = self.serve_example("universal_robots", simulator).wait_ready()
        job = daemon.calibrate(postures=3)
        self.assertEqual(job["verdict"], "accepted", job)
        pose = wait_until("the pose is valid", lambda: pose if (pose := daemon.pose())["valid"] else None)
        mm, mrad = difference(pose["T_base_sensor"], simulator.true_pose())
        print(f"off by {mm:.3f} mm, {mrad:.3f} mrad")
        self.assertLess(mm, MAX_MM)
        self.assertLess(mrad, MAX_MRAD)


if __name__ == "__main__":
    unittest.main(verbosity=2)
