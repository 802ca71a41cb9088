#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Every operation of the daemon answers as its OpenAPI document says: status, headers and body."""

import contextlib
import http.client
import json
import re
import struct
import subprocess
import unittest

from cell import BIN, BUILD, SENSOR, Answer, CellTest, Daemon, wait_until
from contract import Contract

POINTS = ("sensors.kinect2.workspace.tray=[0.5,0.0,0.1]", "sensors.kinect2.workspace.gripper=[0.4,-0.2,0.3]")
HERE_RAD = [0.3, 0.4, 0.2, 0.8, 0.1, 0.5, 0.0]
TOUR_DEG = [[20, 25, 10, 48, 5, 30, 0], [14, 20, 12, 42, 8, 26, 4]]
FORMATS = ("matrix", "quaternion", "rotvec", "ros2", "ros1", "urdf", "kuka", "fanuc", "yaskawa", "mitsubishi", "kawasaki",
           "abb", "ur", "halcon", "opencv")
NO_BODY_WANTED = object()


class OpenApi(CellTest):
    def setUp(self):
        super().setUp()
        self.simulator = self.simulate()
        self.simulator.hurry()
        self.daemon = self.serve(self.simulator, *POINTS, "motion.enabled=true", f"motion.port={self.simulator.motion_port}",
                                 "motion.hold=0s", "motion.max_speed_deg_s=10", "robot.controller_frame=base_link",
                                 f"motion.routes.tour.postures_deg={TOUR_DEG}").wait_ready(90)
        self.contract = Contract(self.daemon.json("/openapi.json"))

    def ask(self, name: str, *values: str, query: str = "", body=NO_BODY_WANTED, status: int | None = None, **headers: str):
        """Calls an operation by its name and holds the answer against the document."""
        method, path, _ = self.contract.operations[name]
        for value in values:
            path = path.replace(path[path.index("{"):path.index("}") + 1], value, 1)
        headers = {key.replace("_", "-"): value for key, value in headers.items()}
        text = None
        if body is not NO_BODY_WANTED:
            text = body if isinstance(body, str) else json.dumps(body)
            headers.setdefault("Content-Type", "application/json")
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=90)
        with contextlib.closing(connection):
            connection.request(method, path + query, text, headers)
            answer = Answer(connection.getresponse())
        self.contract.check(name, answer)
        if status:
            self.assertEqual(answer.status, status, answer.body[:500])
        return answer

    def ask_until_well(self, name: str, *values: str, query: str = "") -> Answer:
        """On a loaded machine joints may be stale for a moment: that is an answer as documented, too."""
        return wait_until(f"{name} answers well", lambda: (
            answer if (answer := self.ask(name, *values, query=query)).status == 200 else None))

    def refused(self, code: str, name: str, *values: str, **wanted):
        answer = self.ask(name, *values, **wanted)
        self.assertEqual(answer.json()["code"], code)

    def calibrate(self) -> str:
        started = self.ask("startCalibration", SENSOR, body={"postures": 3}, status=202, Idempotency_Key="first")
        job = started.json()["id"]
        self.assertEqual(started.headers["Location"], f"/api/v1/calibrations/{job}")
        self.refused("calibration_not_finished", "activateCalibration", job)
        self.refused("calibration_in_progress", "startCalibration", SENSOR, body={})
        wait_until("it ends", lambda: self.ask("getCalibration", job).json()["finished_at"], 120, 0.5)
        self.assertEqual(self.ask("getCalibration", job).json()["status"], "succeeded")
        return job

    def test_the_document_is_sound(self):
        self.assertEqual(self.contract.flaws(), [])

    def test_every_operation_answers_as_documented(self):
        self.before_calibration()
        first = self.calibrate()
        wait_until("the pose is valid", lambda: self.ask("getPose", SENSOR).json()["valid"])
        self.poses()
        self.calibrations(first, self.calibrate_again())
        self.live_state()
        self.clouds()
        self.frames()
        self.robot_model()
        self.motions()
        self.page()
        driven = {name for name, statuses in self.contract.seen.items() if statuses}
        self.assertEqual(driven, set(self.contract.operations))
        for name, statuses in self.contract.seen.items():
            if name == "getPageFile" and not (BUILD / "share/calibrd/web").is_dir():
                continue  # built without Node.js: there is no page
            self.assertTrue(any(status < "300" for status in statuses), f"{name} has never answered well: {statuses}")

    def before_calibration(self):
        self.assertIsNone(self.ask("getPose", SENSOR).json()["last_known"])
        self.refused("pose_not_valid", "getPose", SENSOR, query="?format=matrix", status=409)
        self.refused("no_such_sensor", "getPose", "nobody", status=404)
        self.refused("unknown_format", "getPose", SENSOR, query="?format=runes", status=400)
        self.refused("no_pose", "getNextPosture", SENSOR, status=409)
        self.refused("pose_not_valid", "getCellCloud", status=409)
        self.refused("guess_needed", "startCalibration", SENSOR, body={"postures": 1, "guess": None}, status=409)
        self.refused("paper_needs_guess", "startCalibration", SENSOR, body={"method": "paper", "guess": None}, status=409)
        self.refused("bad_json", "startCalibration", SENSOR, body="{", status=400)
        self.refused("unknown_key", "startCalibration", SENSOR, body={"posture": 1}, status=400)
        self.refused("wrong_content_type", "startCalibration", SENSOR, body="x", Content_Type="text/plain", status=415)
        self.refused("bad_idempotency_key", "startCalibration", SENSOR, body={}, Idempotency_Key="a b", status=400)

    def poses(self):
        pose = self.ask("getPose", SENSOR)
        self.ask("getPose", SENSOR, status=304, If_None_Match=pose.headers["ETag"])
        for name in FORMATS:
            self.assertEqual(self.ask("getPose", SENSOR, query=f"?format={name}", status=200).json()["format"], name)
        self.ask("getDrift", SENSOR, status=200)
        self.ask("getNextPosture", SENSOR, status=200)

    def calibrate_again(self) -> str:
        """A second one, by the call for the whole cell; one that is cancelled lies between."""
        cancelled = self.ask("startCalibration", SENSOR, body={"postures": 50}, status=202).json()["id"]
        self.ask("cancelCalibration", cancelled, status=200)
        wait_until("it is cancelled", lambda: self.ask("getCalibration", cancelled).json()["status"] == "cancelled")
        self.refused("calibration_not_running", "cancelCalibration", cancelled, status=409)
        self.refused("not_activatable", "activateCalibration", cancelled, status=409)
        started = self.ask("startCellCalibrations", body={"postures": 2, "activate": False}, status=202).json()
        second = started["calibrations"][0]["id"]
        wait_until("it ends", lambda: self.ask("getCalibration", second).json()["finished_at"], 120, 0.5)
        self.refused("not_comparable", "diffCalibrations", cancelled, second, status=409)
        return second

    def calibrations(self, first: str, second: str):
        again = self.ask("startCalibration", SENSOR, body={"postures": 3}, status=202, Idempotency_Key="first")
        self.assertEqual(again.json()["id"], first)
        self.refused("idempotency_conflict", "startCalibration", SENSOR, body={"postures": 4}, Idempotency_Key="first")
        page = self.ask("listCalibrations", SENSOR, query="?limit=1", status=200).json()
        self.assertTrue(page["next"].endswith(page["calibrations"][0]["id"]))
        self.ask("getCalibrationCapture", first, status=200)
        self.refused("no_such_calibration", "getCalibrationCapture", "x", status=404)
        self.check_diff(first, second)
        self.assertTrue(self.ask("activateCalibration", first, status=200).json()["current"])
        wait_until("its check agrees", lambda: self.ask("getPose", SENSOR).json()["valid"])

    def check_diff(self, first: str, second: str):
        same = self.ask("diffCalibrations", first, first, status=200).json()
        self.assertLess(same["distance_mm"] + same["angle_mrad"], 1e-6)
        there = self.ask("diffCalibrations", first, second, status=200).json()
        back = self.ask("diffCalibrations", second, first, status=200).json()
        self.assertAlmostEqual(there["distance_mm"], back["distance_mm"], places=6)
        self.assertEqual([point["name"] for point in there["workspace"]], ["gripper", "tray"])
        for point in there["workspace"]:  # two calibrations of a sensor that stands: some tenths of a millimetre
            self.assertLess(point["distance_mm"], 5)
            self.assertGreater(point["distance_mm"], 0)
            self.assertGreater(point["sigma_mm"], 0)

    def live_state(self):
        for name in ("getCell", "getRobot", "listSensors", "getCrossChecks", "getObstacles", "getLiveness", "getMetrics",
                     "getSupportBundle"):
            self.ask(name, status=200)
        self.ask("getSensor", SENSOR, status=200)
        self.ask("getObstacles", query=f"?sensor={SENSOR}", status=200)
        self.refused("no_such_sensor", "getObstacles", query="?sensor=nobody", status=404)
        self.ask("getReadiness", query="?verbose", status=200)
        self.refused("bad_query", "getReadiness", query="?loud", status=400)
        self.simulator.sensor_mode("unplugged")
        wait_until("it is missed", lambda: self.ask("getReadiness", query="?verbose").status == 503)
        self.simulator.sensor_mode("normal")
        wait_until("it is back", lambda: self.ask("getReadiness").status == 200, 60)
        wait_until("the pose is valid", lambda: self.ask("getPose", SENSOR).json()["valid"], 60)
        self.events()

    def events(self):
        for name, path in (("streamEvents", "/api/v1/events"), ("streamEvents", "/api/v1/events?joints=true"), ("streamJoints", "/api/v1/robot/joints")):
            connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=20)
            with contextlib.closing(connection):
                connection.request("GET", path)
                answer = connection.getresponse()
                answer.body = answer.readline()  # of a body without an end
                self.contract.check(name, answer)

    def clouds(self):
        self.ask("recordCapture", SENSOR, body={"postures": 1, "timeout_s": 60, "note": "contract"}, status=200)
        for name in ("getMeasuredCloud", "getVirtualCloud", "getResidualCloud"):
            for wanted in ("", "?frame=base", "?format=ply", "?format=pcd&frame=base", "?format=binary"):
                self.check_cloud(wanted, self.ask_until_well(name, SENSOR, query=wanted))
        for wanted in ("", "?format=pcd", "?format=binary&robot=false"):
            self.check_cloud(wanted, self.ask_until_well("getCellCloud", query=wanted))
        self.refused("bad_query", "getMeasuredCloud", SENSOR, query="?format=xyz", status=400)

    def check_cloud(self, wanted: str, answer: Answer):
        """The body holds the points that the headers announce."""
        size = int(answer.headers["Calibrd-Points"]) * int(answer.headers["Calibrd-Point-Bytes"])
        types = {"f4": "f", "u1": "B"}
        layout = "<" + "".join(types[kind] for kind in answer.headers["Calibrd-Fields"].split()[1::2])
        self.assertEqual(struct.calcsize(layout), int(answer.headers["Calibrd-Point-Bytes"]))
        head = {"pcd": b"# .PCD v0.7", "binary": b""}.get(wanted.partition("format=")[2].partition("&")[0], b"ply\n")
        self.assertTrue(answer.body.startswith(head), answer.body[:20])
        if not head:
            self.assertEqual(len(answer.body), size)
        self.assertGreater(size, 1000)
        for x, y, z, *_ in struct.iter_unpack(layout, answer.body[len(answer.body) - size:]):
            self.assertLess(abs(x) + abs(y) + abs(z), 50)

    def motions(self):
        self.simulator.tell("PUT", "/motion", mode="postures", postures_rad=HERE_RAD, speed_rad_s=3)
        wait_until("nothing hinders", lambda: not self.ask("listMotions").json()["hindrance"], 60)
        self.refused("no_such_motion", "getMotion", "x", status=404)
        self.refused("no_such_motion_route", "startMotion", body={"route": "x"}, status=404)
        self.refused("bad_value", "startMotion", body={}, status=400)
        started = self.ask("startMotion", body={"route": "tour"}, status=202)
        motion = started.json()["id"]
        self.assertEqual(started.headers["Location"], f"/api/v1/robot/motions/{motion}")
        self.refused("motion_in_progress", "startMotion", body={"route": "tour"}, status=409)
        self.ask("stopMotion", motion, status=200)
        wait_until("it stops", lambda: self.ask("getMotion", motion).json()["finished_at"])
        self.refused("motion_ended", "stopMotion", motion, status=409)

    def frames(self):
        """One part holds what its header says."""
        answer = self.ask("streamFrames", SENSOR, query="?count=1&step=2", status=200)
        (length,) = struct.unpack_from("<I", answer.body)
        header = json.loads(answer.body[4:4 + length])
        (pixels,) = struct.unpack_from("<I", answer.body, 4 + length)
        self.assertEqual((header["camera"]["width"], header["camera"]["height"]), (256, 212))
        self.assertEqual(pixels, 6 * 256 * 212)
        self.assertEqual(len(answer.body), 8 + length + pixels)
        self.assertTrue(header["pose_valid"])
        self.assertGreater(sum(answer.body[-256 * 212:]), 1000)  # the classes
        self.refused("bad_query", "streamFrames", SENSOR, query="?step=9", status=400)

    def robot_model(self):
        urdf = self.ask("getRobotUrdf", status=200)
        self.assertIn(b"<robot", urdf.body)
        link = self.ask("getRobot", status=200).json()["links"][1]["name"]
        mesh = self.ask("getLinkMesh", link, status=200).body
        self.assertEqual(len(mesh), 84 + 50 * struct.unpack_from("<I", mesh, 80)[0])
        self.refused("no_such_link", "getLinkMesh", "x", status=404)
        self.assertEqual(self.ask("getSession", status=200).json(), {"caller": "local", "scope": "admin"})

    def page(self):
        self.assertIn(b"calibrd", self.ask("getPage", status=200).body)
        for file in re.findall(rb"\./(assets/[\w.-]+)", self.ask("getPage").body):
            self.ask("getPageFile", file.decode().removeprefix("assets/"), status=200)
        self.refused("not_found", "getPageFile", "none", status=404)
        self.ask("getOpenApi", status=200)
        for name in ("getDocs", "getDocsScript", "getDocsStyle"):
            answer = self.ask(name, status=200)
            self.assertIn("default-src 'none'", answer.headers["Content-Security-Policy"])
            self.assertNotIn(b"http://", answer.body)
            self.assertNotIn(b"https://", answer.body)


class Doors(CellTest):
    """What every operation answers to those who may not come in; without robot and sensor, which it does not depend on."""

    def setUp(self):
        super().setUp()
        tokens = self.folder / "tokens.json"
        made = subprocess.run([BIN / "calibrd", "token", "create", "page", "--scope", "read", "--tokens-file", tokens],
                              capture_output=True, text=True, timeout=20, check=True)
        self.read_token = made.stdout.strip()
        self.daemon = Daemon(self.folder, 9, self.folder / "no-world", f"server.tokens_file={tokens}",
                             "server.loopback_rate_limit=0")
        self.programs.append(self.daemon.wait_alive())
        self.contract = Contract(self.daemon.json("/openapi.json"))

    def ask(self, name: str, **headers: str) -> Answer:
        method, path, _ = self.contract.operations[name]
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=20)
        with contextlib.closing(connection):
            connection.request(method, re.sub(r"\{\w+\}", "x", path), headers=headers)
            response = connection.getresponse()
            if response.length is None and response.status == 200:  # it has no end
                response.length = 1
            answer = Answer(response)
        self.contract.check(name, answer)
        return answer

    def test_every_operation_is_refused_as_documented(self):
        for name, (_, _, operation) in self.contract.operations.items():
            scope = operation["security"][0]["bearer"][0] if operation["security"] else "open"
            with self.subTest(name):
                self.assertEqual(self.ask(name, Host="other.example").json()["code"], "wrong_host")
                self.assertEqual(self.ask(name, Origin="http://other.example").json()["code"], "wrong_origin")
                if scope == "open":
                    self.assertIn(self.ask(name).status, (200, 404, 503))
                    continue
                self.assertEqual(self.ask(name).json()["code"], "token_needed")
                self.assertEqual(self.ask(name, Authorization="Bearer x").json()["code"], "token_unknown")
                known = self.ask(name, Authorization=f"Bearer {self.read_token}")
                self.assertEqual(known.status == 403, scope != "read", known.status)


if __name__ == "__main__":
    unittest.main()
