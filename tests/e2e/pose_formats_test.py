#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""A real daemon's pose in every format: all of them say the same as the matrix, read by the conventions of their makers."""

import math
import shlex
import unittest
import xml.etree.ElementTree as ElementTree

from cell import SENSOR, CellTest, wait_until
from poses import Pose, axis_turn, difference, inverse, multiply, numbers, shift

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
OF_CONTROLLERS = ("kuka", "fanuc", "yaskawa", "mitsubishi", "kawasaki", "abb", "ur")
FORMATS = ("matrix", "quaternion", "rotvec", "ros2", "ros1", "urdf", *OF_CONTROLLERS, "halcon", "opencv")
MAX_MM, MAX_MRAD = 1e-6, 1e-6  # 1e-9 m and rad
MAX_TEXT_MM, MAX_TEXT_MRAD = 1e-3, 1e-3


def turns(*axes_and_angles) -> Pose:
    """The product of turns, left to right; rad."""
    T = shift((0, 0, 0))
    for axis, angle in axes_and_angles:
        T = multiply(T, axis_turn(axis, angle))
    return T


def placed(t_m, rotation: Pose) -> Pose:
    return multiply(shift(tuple(t_m)), rotation)


def of_quaternion(x: float, y: float, z: float, w: float) -> Pose:
    sine = math.sqrt(x * x + y * y + z * z)
    return axis_turn((x, y, z), 2 * math.atan2(sine, w)) if sine > 0 else turns()


def of_vector(v) -> Pose:
    return axis_turn(tuple(v), math.hypot(*v)) if any(v) else turns()


def of_controller(told: dict, *named_axes) -> Pose:
    """X, Y, Z in mm, then turns about axes by angles of these names in deg, in the order of the product."""
    return placed((told[f"{axis}_mm"] / 1e3 for axis in "XYZ"),
                  turns(*((axis, math.radians(told[f"{name}_deg"])) for axis, name in named_axes)))


def of_halcon(told: dict) -> Pose:
    *t, a, b, g, kind = told["pose"]
    assert kind == 0, kind
    return placed(t, turns((X, math.radians(a)), (Y, math.radians(b)), (Z, math.radians(g))))


READ = {
    "matrix": lambda told: told["T_base_sensor"],
    "quaternion": lambda told: placed(told["translation_m"], of_quaternion(*told["rotation_xyzw"])),
    "rotvec": lambda told: placed(told["translation_m"], of_vector(told["rotation_vector_rad"])),
    "ros2": lambda told: placed(told["translation_m"], of_quaternion(*told["rotation_xyzw"])),
    "ros1": lambda told: placed(told["translation_m"], of_quaternion(*told["rotation_xyzw"])),
    "urdf": lambda told: placed(told["xyz_m"], turns(*zip((Z, Y, X), reversed(told["rpy_rad"])))),
    "kuka": lambda told: of_controller(told, (Z, "A"), (Y, "B"), (X, "C")),
    "fanuc": lambda told: of_controller(told, (Z, "R"), (Y, "P"), (X, "W")),
    "yaskawa": lambda told: of_controller(told, (Z, "Rz"), (Y, "Ry"), (X, "Rx")),
    "mitsubishi": lambda told: of_controller(told, (Z, "C"), (Y, "B"), (X, "A")),
    "kawasaki": lambda told: of_controller(told, (Z, "O"), (Y, "A"), (Z, "T")),
    "abb": lambda told: placed((v / 1e3 for v in told["trans_mm"]),
                               of_quaternion(*told["rot_wxyz"][1:], told["rot_wxyz"][0])),
    "ur": lambda told: placed(told["pose"][:3], of_vector(told["pose"][3:])),
    "halcon": of_halcon,
    "opencv": lambda told: placed(told["tvec_m"], of_vector(told["rvec_rad"])),
}


class PoseFormats(CellTest):
    def told(self, daemon, name: str) -> dict:
        told = daemon.json(f"/api/v1/sensors/{SENSOR}/pose?format={name}")
        self.assertEqual(told["format"], name)
        return told

    def expect_same(self, told: Pose, truth: Pose, max_mm: float = MAX_MM, max_mrad: float = MAX_MRAD):
        mm, mrad = difference(told, truth)
        self.assertLess(mm, max_mm)
        self.assertLess(mrad, max_mrad)

    def expect_refused(self, daemon, names, code: str):
        for name in names:
            with self.subTest(name):
                refused = daemon.get(f"/api/v1/sensors/{SENSOR}/pose?format={name}")
                self.assertEqual((refused.status, refused.json()["code"]), (409, code))

    def wait_valid(self, daemon) -> Pose:
        return wait_until("the pose is valid", lambda: (
            pose["T_base_sensor"] if (pose := daemon.pose())["valid"] else None), 60)

    def test_every_format_says_what_the_matrix_says(self):
        simulator = self.simulate()
        simulator.hurry()
        daemon = self.serve(simulator, "drift.healing=off").wait_ready()
        self.expect_refused(daemon, FORMATS, "pose_not_valid")
        job = daemon.calibrate()
        self.assertEqual(job["verdict"], "accepted", job)
        T_base_sensor = self.wait_valid(daemon)
        robot = daemon.robot()
        self.assertEqual(robot["controller_frame"], "base")
        T_base_controller = next(link["T_base_link"] for link in robot["links"] if link["name"] == "base")
        self.assertGreater(difference(T_base_controller, turns())[0], 100, "the demo's controller counts from elsewhere")
        for name in FORMATS:
            truth = T_base_sensor
            if name in OF_CONTROLLERS:
                truth = multiply(inverse(T_base_controller), T_base_sensor)
            with self.subTest(name):
                told = self.told(daemon, name)
                self.expect_same(READ[name](told), inverse(truth) if name == "opencv" else truth)
                self.assertEqual(told["inverse"], name == "opencv")
                self.assertEqual({told["from_frame"], told["to_frame"]},
                                 {f"{SENSOR}_optical", "base" if name in OF_CONTROLLERS else "base_link"})
        self.expect_ready_made_texts(daemon, T_base_sensor)

        daemon.stop()
        daemon = self.serve(simulator, "drift.healing=off", "robot.controller_frame=").wait_ready()
        self.wait_valid(daemon)
        self.expect_refused(daemon, OF_CONTROLLERS, "no_controller_frame")
        self.expect_same(READ["urdf"](self.told(daemon, "urdf")), T_base_sensor)

    def expect_ready_made_texts(self, daemon, T_base_sensor: Pose):
        """Of the formats whose text a shell or an XML parser reads."""
        words = shlex.split(self.told(daemon, "ros2")["text"])
        self.assertEqual(words[:4], ["ros2", "run", "tf2_ros", "static_transform_publisher"])
        options = dict(zip(words[4::2], words[5::2]))
        self.assertEqual((options["--frame-id"], options["--child-frame-id"]), ("base_link", f"{SENSOR}_optical"))
        values = [float(options[f"--{name}"]) for name in ("x", "y", "z", "qx", "qy", "qz", "qw")]
        self.expect_same(placed(values[:3], of_quaternion(*values[3:])), T_base_sensor, MAX_TEXT_MM, MAX_TEXT_MRAD)

        words = shlex.split(self.told(daemon, "ros1")["text"])
        self.assertEqual(words[10:], ["base_link", f"{SENSOR}_optical"])
        values = [float(word) for word in words[3:10]]
        self.expect_same(placed(values[:3], of_quaternion(*values[3:])), T_base_sensor, MAX_TEXT_MM, MAX_TEXT_MRAD)

        urdf = self.told(daemon, "urdf")
        joint = ElementTree.fromstring(f"<robot>{urdf['text_joint']}</robot>").find("joint")
        self.assertEqual((joint.find("parent").get("link"), joint.find("child").get("link")),
                         ("base_link", f"{SENSOR}_optical"))
        for origin in (joint.find("origin"), ElementTree.fromstring(urdf["text"])):
            roll, pitch, yaw = numbers(origin.get("rpy"))
            told = placed(numbers(origin.get("xyz")), turns((Z, yaw), (Y, pitch), (X, roll)))
            self.expect_same(told, T_base_sensor, MAX_TEXT_MM, MAX_TEXT_MRAD)


if __name__ == "__main__":
    unittest.main(verbosity=2)
