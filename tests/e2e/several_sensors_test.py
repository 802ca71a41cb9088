#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Two and three sensors on one robot: calibrated by one call from one motion of the robot, checked against each other, seen
as one cloud, and what else stands in the cell with its distance from the robot."""

import json
import re
import statistics
import struct
import unittest

from cell import BUILD, SENSOR, SOURCE, URDF, CellTest, Daemon, Simulator, call, wait_until
from poses import Robot, apply, difference, distance_to_triangle, inverse, read_stl

MAX_MM, MAX_MRAD = 3.0, 3.0
TOO_LONG = 1.03  # a focal length by so much that the sensor's own views accept it
RATE_HZ = 10  # several rendered sensors on a small machine
PLACES = {SENSOR: [1.35, 0.75, 0.85], "left": [1.15, -0.85, 0.95], "top": [0.6, 0.3, 1.75]}
DEMO = json.loads((SOURCE / "config/demo_cell/world.json").read_text())


class Points:
    """Of a merged cloud: p[i] was seen by sensor[i]."""

    def __init__(self, data: bytes):
        header, _, body = data.partition(b"end_header\n")
        lines = header.decode().splitlines()
        self.comments = dict(line.split(" ", 2)[1:] for line in lines if line.startswith("comment "))
        count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
        rows = list(struct.iter_unpack("<3fB", body))
        assert len(rows) == count, (len(rows), count)
        self.of = {}
        for x, y, z, sensor in rows:
            self.of.setdefault(sensor, []).append((x, y, z))


class SeveralSensors(CellTest):
    def start(self, *sensors: str, wrong: dict[str, float] | None = None) -> tuple[Simulator, Daemon]:
        """`wrong`: by which the focal length of a sensor is configured too long."""
        one = DEMO["sensors"][0]
        world = {**DEMO, "sensors": [{**one, "id": name, "position_m": PLACES[name], "rate_hz": RATE_HZ} for name in sensors]}
        path = self.folder / "several.json"
        path.write_text(json.dumps(world))
        self.programs.append(simulator := Simulator(self.folder, world=path))
        settings = []
        for index, name in enumerate(sensors):
            settings += [f"sensors.{name}.uri=calibrd-sim://{index}", f"sensors.{name}.fps={RATE_HZ}",
                         f"sensors.{name}.driver_directory={BUILD / 'lib/calibrd-sim-openni'}", f"sensors.{name}.latency=20ms"]
            camera = dict(one["camera"])
            for key in ("fx", "fy"):
                camera[key] *= (wrong or {}).get(name, 1.0)
            settings += [f"sensors.{name}.{key}={camera[key]}" for key in ("fx", "fy", "cx", "cy", "distortion")]
        self.settings = settings
        self.programs.append(daemon := Daemon(self.folder, simulator.controller_port, simulator.world_file, *settings))
        simulator.tell("PUT", "/motion", mode="run", seed=11, count=12, speed_rad_s=1.5, hold_s=1.2)
        return simulator, daemon.wait_ready()

    def calibrate_all(self, simulator: Simulator, daemon: Daemon, count: int) -> None:
        answer = call(daemon.port, "POST", "/api/v1/cell/calibrations", {"postures": 5})
        self.assertEqual(answer.status, 202, answer.body)
        started = answer.json()
        self.assertEqual((len(started["calibrations"]), started["refused"]), (count, []))
        again = call(daemon.port, "POST", "/api/v1/cell/calibrations", {})
        self.assertEqual((again.status, again.json()["code"]), (409, "calibration_in_progress"))
        for job in started["calibrations"]:
            ended = daemon.wait_calibration(job["location"])
            self.assertEqual((ended["status"], ended["verdict"]), ("succeeded", "accepted"), ended)
        for truth in simulator.truth()["sensors"]:
            pose = wait_until(f"{truth['id']} is valid", lambda: (
                pose if (pose := daemon.json(f"/api/v1/sensors/{truth['id']}/pose"))["valid"] else None))
            mm, mrad = difference(pose["T_base_sensor"], truth["T_base_sensor"])
            print(f"{truth['id']}: off by {mm:.3f} mm, {mrad:.3f} mrad")
            self.assertLess(mm, MAX_MM)
            self.assertLess(mrad, MAX_MRAD)

    def cloud(self, daemon: Daemon, robot: str) -> Points:
        answer = daemon.get(f"/api/v1/cell/cloud?robot={robot}")
        self.assertEqual(answer.status, 200, answer.body[:500])
        return Points(answer.body)

    def expect_one_bench(self, points: Points) -> None:
        """Every sensor of the cloud sees the top of the workbench, where it is: at z = 0."""
        for sensor, seen in points.of.items():
            bench = [z for x, y, z in seen if 0.35 < x < 0.6 and abs(y) < 0.2 and abs(z) < 0.03]
            self.assertGreater(len(bench), 100, f"sensor {sensor}")
            self.assertLess(abs(statistics.median(bench)), 0.003, f"sensor {sensor}")

    def obstacles(self, daemon: Daemon) -> dict[str, dict] | None:
        """By sensor, once every sensor has been able to look."""
        report = daemon.json("/api/v1/cell/obstacles")
        self.assertIs(report["safety_function"], False)
        self.assertEqual(report["base_frame"], "base_link")
        sensors = {sensor["sensor"]: sensor for sensor in report["sensors"]}
        return sensors if all(sensor["looked"] for sensor in sensors.values()) else None

    def expect_distance_of_own_kinematics(self, seen: dict, names: list[str]) -> None:
        robot = Robot(URDF)
        poses = robot.link_poses(dict(zip(names, seen["joint_positions_rad"])))
        for obstacle in seen["obstacles"]:
            nearest = obstacle["robot"]
            distance = {link: min(distance_to_triangle(apply(inverse(poses[link]), nearest["point_m"]), triangle)
                                  for triangle in read_stl(path)) for link, path in robot.meshes.items()}
            self.assertAlmostEqual(nearest["distance_m"], min(distance.values()), delta=2e-3)
            self.assertAlmostEqual(nearest["distance_m"], distance[nearest["link"]], delta=2e-3)

    @staticmethod
    def with_joints(cloud):
        return cloud if all(f"Calibrd-Sensor-{i}-Joint-Stamp-Ns" in cloud.comments for i in range(2)) else None

    def test_two_are_calibrated_by_one_call_and_see_one_cell(self):
        simulator, daemon = self.start(SENSOR, "left")
        before = daemon.json("/api/v1/cell/obstacles")["sensors"]
        self.assertEqual([(s["code"], s["obstacles"]) for s in before], [("pose_not_valid", [])] * 2)
        self.assertEqual(daemon.get("/api/v1/cell/cloud").status, 409)
        self.calibrate_all(simulator, daemon, 2)

        # A frame that came while the link to the robot had stalled for a moment has no joints.
        whole = wait_until("both frames have joints", lambda: self.with_joints(self.cloud(daemon, "true")))
        self.assertEqual({whole.comments["Calibrd-Sensor-0"], whole.comments["Calibrd-Sensor-1"]}, {SENSOR, "left"})
        self.assertIn("Calibrd-Sensor-1-Joint-Stamp-Ns", whole.comments)
        self.expect_one_bench(whole)
        simulator.tell("PUT", "/motion", mode="hold")
        wait_until("the robot stands", lambda: daemon.robot()["joints"]["still"])
        with_robot, without = self.cloud(daemon, "true"), self.cloud(daemon, "false")
        for sensor in (0, 1):
            self.assertLess(len(without.of[sensor]), 0.99 * len(with_robot.of[sensor]))

        quiet = wait_until("both look for obstacles", lambda: self.obstacles(daemon))
        print({name: [(o["points"], o["centre_m"], o["before_known_share"]) for o in seen["obstacles"]]
               for name, seen in quiet.items()})
        self.assertEqual({name: [o for o in seen["obstacles"] if o["before_known_share"] > 0.5]
                          for name, seen in quiet.items()}, {SENSOR: [], "left": []})
        simulator.tell("PUT", "/objects/box_tall", shift_m=[0.75, -0.1, 0.0])
        agreeing = daemon.json("/api/v1/cell/cross-checks")["pairs"]
        print(agreeing)
        self.assertEqual([(p["compared"], p["overlap"], p["agree"]) for p in agreeing], [(True, True, True)])
        truth = (0.4, -0.55, 0.14)  # box_tall: 0.15 x 0.25 x 0.28 m

        def seen_by_both():
            seen = self.obstacles(daemon)
            near = seen and {name: [o for o in s["obstacles"] if max(abs(a - b) for a, b in zip(o["centre_m"], truth)) < 0.2]
                             for name, s in seen.items()}
            return seen if near and all(near.values()) else None

        seen = wait_until("both see the box where it was put", seen_by_both)
        names = daemon.robot()["joint_names"]
        for name in seen:
            self.expect_distance_of_own_kinematics(seen[name], names)
            self.assertLess(seen[name]["age_s"], 1.0)
        simulator.tell("POST", "/sensors/left/knock", shift_m=[0.03, 0.0, 0.0], turn_deg=[0.0, 3.0, 0.0])
        blind = wait_until("the knocked sensor no longer looks", lambda: next(
            (s for s in daemon.json("/api/v1/cell/obstacles?sensor=left")["sensors"] if not s["looked"]), None))
        self.assertEqual((blind["code"], blind["obstacles"]), ("pose_not_valid", []))
        alone = self.cloud(daemon, "true")
        self.assertTrue(re.match("left pose_not_valid", alone.comments["Calibrd-Left-Out"]))
        self.assertEqual(set(alone.of), {0})

    def test_three_are_calibrated_by_one_call_and_see_one_cell(self):
        simulator, daemon = self.start(SENSOR, "left", "top")
        self.calibrate_all(simulator, daemon, 3)
        cloud = self.cloud(daemon, "true")
        self.assertEqual(set(cloud.of), {0, 1, 2})
        self.expect_one_bench(cloud)

    def test_one_that_is_knocked_is_healed_and_the_other_stays_as_it_is(self):
        simulator, daemon = self.start(SENSOR, "left")
        self.calibrate_all(simulator, daemon, 2)
        poses = {name: daemon.json(f"/api/v1/sensors/{name}/pose") for name in (SENSOR, "left")}
        wait_until("both are watched and stand", lambda: all(
            daemon.json(f"/api/v1/sensors/{name}/drift")["verdict"] == "in_place" for name in poses))
        simulator.tell("POST", "/sensors/left/knock", turn_deg=[0, 0, 3.0], shift_m=[0.02, 0.02, 0.01])

        def healed():
            other = daemon.json(f"/api/v1/sensors/{SENSOR}/pose")
            self.assertTrue(other["valid"], other)
            self.assertEqual(other["calibration"], poses[SENSOR]["calibration"])
            pose = daemon.json("/api/v1/sensors/left/pose")
            return pose if pose["valid"] and pose["calibration"] != poses["left"]["calibration"] else None
        pose = wait_until("the knocked one is healed", healed, 60)
        truth = next(t for t in simulator.truth()["sensors"] if t["id"] == "left")
        mm, mrad = difference(pose["T_base_sensor"], truth["T_base_sensor"])
        print(f"the knocked one of two: off by {mm:.2f} mm, {mrad:.2f} mrad")
        self.assertLess(mm, MAX_MM)
        self.assertLess(mrad, MAX_MRAD)

    def test_one_with_wrong_intrinsics_is_contradicted_by_the_other_though_its_own_views_cannot_tell(self):
        _, daemon = self.start(SENSOR, "top", wrong={"top": TOO_LONG})
        started = call(daemon.port, "POST", "/api/v1/cell/calibrations", {"postures": 5}).json()["calibrations"]
        ended = [daemon.wait_calibration(job["location"]) for job in started]
        print([(job["sensor"], job["verdict"], job["result"]["sigma_position_m"],
                [reason["text"] for reason in job["result"]["reasons"]]) for job in ended])
        codes = [reason["code"] for job in ended for reason in job["result"]["reasons"]]
        self.assertIn("sensors_disagree", codes)
        valid = [daemon.json(f"/api/v1/sensors/{job['sensor']}/pose")["valid"] for job in ended]
        self.assertEqual(sorted(valid), [False, True])

    def test_a_served_pose_that_a_better_one_contradicts_is_served_no_longer_not_even_after_a_restart(self):
        simulator, daemon = self.start(SENSOR, "top", wrong={"top": TOO_LONG})
        for name in ("top", SENSOR):
            job, = call(daemon.port, "POST", "/api/v1/cell/calibrations", {"sensors": [name]}).json()["calibrations"]
            ended = daemon.wait_calibration(job["location"])
            self.assertEqual(ended["verdict"], "accepted", ended)
        self.assertIn("sensors_disagree", [reason["code"] for reason in ended["result"]["reasons"]])
        pose = daemon.json("/api/v1/sensors/top/pose")
        self.assertEqual((pose["valid"], pose["state"]), (False, "unverified"))
        self.assertIn("does not lie at the same place", pose["reason"])
        self.assertTrue(daemon.json(f"/api/v1/sensors/{SENSOR}/pose")["valid"])

        daemon.stop()
        self.programs.append(daemon := Daemon(self.folder, simulator.controller_port, simulator.world_file, *self.settings,
                                              "drift.healing=off"))
        daemon.wait_ready()
        wait_until("the other pose is valid again", lambda: daemon.json(f"/api/v1/sensors/{SENSOR}/pose")["valid"])
        self.assertEqual(daemon.json("/api/v1/sensors/top/pose")["state"], "drifted")


if __name__ == "__main__":
    unittest.main(verbosity=2)
