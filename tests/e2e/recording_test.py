#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""A capture recorded from the live cell calibrates offline; a spoilt one is refused with a reason."""

import io
import json
import os
import struct
import subprocess
import tarfile
import unittest
import zlib
from unittest import mock

from cell import BIN, SENSOR, CellTest, call, wait_until
from poses import axis_turn, difference, multiply, shift

POSTURES = 3


def png(width: int, height: int, bits: int) -> bytes:
    """A black grey-scale image."""
    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    rows = zlib.compress((b"\0" + b"\0" * (width * bits // 8)) * height)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)) +
            chunk(b"IDAT", rows) + chunk(b"IEND", b""))


class Recording(CellTest):
    def record(self):
        """Records from the live cell; leaves the capture's folder, the true pose and a guess off by some."""
        simulator = self.simulate()
        simulator.hurry()
        with mock.patch.dict(os.environ, TMPDIR="/nonexistent"):  # it writes where its storage is, and nowhere else
            daemon = self.serve(simulator).wait_ready()
        answer = call(daemon.port, "POST", f"/api/v1/sensors/{SENSOR}/captures",
                      {"postures": POSTURES, "timeout_s": 120, "note": "end to end"}, timeout_s=150)
        self.assertEqual(answer.status, 200, answer.body[:500])
        with tarfile.open(fileobj=io.BytesIO(answer.body)) as archive:
            archive.extractall(self.folder / "capture")
        self.capture = next((self.folder / "capture").rglob("capture.json")).parent
        self.true_pose = simulator.true_pose()
        guess = multiply(multiply(shift((0.02, -0.02, 0.01)), self.true_pose), axis_turn((1, 2, 0), 0.03))
        self.guess = self.folder / "guess.json"
        self.guess.write_text(json.dumps({"T_base_sensor": guess}))
        self.check_that_a_bundle_repeats(daemon)
        daemon.stop()
        simulator.stop()

    def check_that_a_bundle_repeats(self, daemon):
        """The views of the newest calibration are in the support bundle, and give its pose again."""
        served = daemon.calibrate()
        kept = f"captures/{served['id']}.tar"
        wait_until("the views are kept", (self.folder / kept).exists)
        wait_until("the pose's change is audited", lambda: f'"made":"/api/v1/calibrations/{served["id"]}"' in (
            (self.folder / "audit.jsonl").read_text().splitlines()[-1]))
        bundle = tarfile.open(fileobj=io.BytesIO(daemon.get("/api/v1/support_bundle").body))
        name = next(name for name in bundle.getnames() if name.endswith(kept))
        with tarfile.open(fileobj=bundle.extractfile(name)) as archive:
            archive.extractall(self.folder / "again")
        folder = next((self.folder / "again").rglob("capture.json")).parent
        ended = subprocess.run([BIN / "calibrd", "calibrate", folder], capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        mm, mrad = difference(json.loads(ended.stdout)["T_base_sensor"], served["result"]["T_base_sensor"])
        self.assertLess(max(mm, mrad), 3)

    def calibrate(self, *options):
        return subprocess.run([BIN / "calibrd", "calibrate", self.capture, "--guess", self.guess, *options],
                              capture_output=True, text=True, timeout=120, check=False)

    def calibrate_into(self, redirection: str):
        command = f'exec "$0" calibrate "$1" --guess "$2" {redirection}'
        return subprocess.run(["sh", "-c", command, BIN / "calibrd", self.capture, self.guess], stderr=subprocess.PIPE,
                              text=True, timeout=120, check=False)

    def expect_refused(self, *words: str):
        ended = self.calibrate()
        print(ended.stderr.strip())
        self.assertEqual((ended.returncode, ended.stdout), (2, ""), ended.stderr)
        for word in words:
            self.assertIn(word, ended.stderr)

    def spoil(self, change) -> None:
        """Changes capture.json; `change` gets it as it was recorded."""
        description = json.loads(self.recorded)
        change(description)
        (self.capture / "capture.json").write_text(json.dumps(description))

    def test_it_calibrates_and_each_way_to_spoil_it_is_named(self):
        self.record()
        self.recorded = (self.capture / "capture.json").read_text()
        with self.subTest("as recorded"):
            ended = self.calibrate("--json")
            self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
            result = json.loads(ended.stdout)
            mm, mrad = difference(result["T_base_sensor"], self.true_pose)
            print(f"{result['verdict']}, {result['views']} views, off by {mm:.3f} mm, {mrad:.3f} mrad")
            self.assertEqual((result["verdict"], result["views"]), ("accepted", POSTURES))
            self.assertLess(max(mm, mrad), 3)
        with self.subTest("where to move next"):
            ended = self.calibrate("--suggest", "--table-height", "0.02")
            answer = json.loads(ended.stdout)
            suggested = answer["next_posture"]
            self.assertCountEqual(suggested["joint_names"], json.loads(self.recorded)["robot"]["joint_names"])
            self.assertEqual(len(suggested["positions_rad"]), len(suggested["joint_names"]))
            self.assertLess(suggested["expected"]["sigma_position_m"], answer["sigma_position_m"])
            self.assertLess(suggested["expected"]["sigma_rotation_rad"], answer["sigma_rotation_rad"])
            self.assertIn("seen from the sensor", suggested["improves"])
            self.assertEqual(self.calibrate("--table-height", "0.02").returncode, 2)
        with self.subTest("output that cannot be written"):
            for redirection in (">/dev/full", ">&-"):
                ended = self.calibrate_into(redirection)
                self.assertEqual(ended.returncode, 2, redirection)
                self.assertIn("stdout", ended.stderr, redirection)
        with self.subTest("image missing"):
            self.spoil(lambda c: c["frames"][0].update(image="none.png"))
            self.expect_refused("none.png")
            ended = self.calibrate("--depth-only")
            self.assertNotEqual(ended.returncode, 2, ended.stderr)
            self.assertEqual(json.loads(ended.stdout)["views"], POSTURES)
        spoilt = {
            "no frame": (lambda c: c.update(frames=[]), "no frame"),
            "unknown format": (lambda c: c.update(format="capture/9"), "capture/1"),
            "joint missing": (lambda c: [c["robot"]["joint_names"].pop(),
                                         *(f["joint_positions_rad"].pop() for f in c["frames"])], "joint_t"),
            "joint unknown": (lambda c: c["robot"]["joint_names"].__setitem__(0, "joint_x"), "joint_x"),
            "too few positions": (lambda c: c["frames"][0]["joint_positions_rad"].pop(), "joint_positions_rad"),
            "no focal length": (lambda c: c["sensor"].pop("fx"), "fx"),
            "depth image missing": (lambda c: c["frames"][0].update(depth="none.png"), "none.png"),
            "no URDF": (lambda c: c["robot"].update(urdf="none.urdf"), "none.urdf"),
        }
        for name, (change, word) in spoilt.items():
            with self.subTest(name):
                self.spoil(change)
                self.expect_refused(word)
        images = {"wrong size": (png(100, 80, 16), "spoilt.png"), "wrong depth": (png(512, 424, 8), "frames[0].depth"),
                  "empty": (b"", "spoilt.png")}
        for name, (image, word) in images.items():
            with self.subTest(name):
                (self.capture / "spoilt.png").write_bytes(image)
                self.spoil(lambda c: c["frames"][0].update(depth="spoilt.png"))
                self.expect_refused(word)
        with self.subTest("frames without a measurement"):
            (self.capture / "spoilt.png").write_bytes(png(512, 424, 16))
            self.spoil(lambda c: [f.update(depth="spoilt.png") for f in c["frames"]])
            ended = self.calibrate()
            self.assertEqual(ended.returncode, 3, ended.stderr)
            self.assertEqual(json.loads(ended.stdout)["verdict"], "rejected")
        with self.subTest("not a number"):
            (self.capture / "capture.json").write_text(self.recorded.replace('"fx":', '"fx": NaN, "fx_was":', 1))
            self.expect_refused("capture.json")


if __name__ == "__main__":
    unittest.main(verbosity=2)
