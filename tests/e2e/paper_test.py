#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's method on a recording: its options, and a program without its shared object."""

import json
import shutil
import subprocess
import unittest

from cell import BIN, URDF, CellTest
from poses import difference, multiply, shift

AROUND = "-0.9,-0.9,0.3,0.9,0.9,2.4"  # sensor frame: all of the robot at 1.34 m


class PaperMethod(CellTest):
    def setUp(self):
        super().setUp()
        self.capture, self.guess = self.folder / "capture", self.folder / "guess.json"
        subprocess.run([BIN / "calibrd-sim", "capture", self.capture, "--urdf", URDF, "--level", "clean", "--postures", "2",
                        "--min-distance", "1.34", "--max-distance", "1.34"], check=True, stdout=subprocess.DEVNULL)
        self.true_pose = json.loads((self.capture / "truth.json").read_text())["T_base_sensor"]
        self.guess.write_text(json.dumps({"T_base_sensor": multiply(shift((0.02, -0.02, 0.01)), self.true_pose)}))

    def calibrate(self, *options, program=BIN / "calibrd"):
        return subprocess.run([program, "calibrate", self.capture, "--guess", self.guess, *options],
                              capture_output=True, text=True, timeout=120, check=False)

    def result(self, *options, **more) -> dict:
        ended = self.calibrate("--method", "paper", *options, **more)
        self.assertEqual((ended.returncode, ended.stderr), (3, ""))
        return json.loads(ended.stdout)

    def codes(self, result: dict) -> set[str]:
        return {reason["code"] for reason in result["reasons"]}

    def test_it_ends_near_the_truth_and_is_never_accepted(self):
        for options in ((), ("--roi", AROUND), ("--sampling", "three-sensors")):
            with self.subTest(options):
                result = self.result(*options)
                mm, mrad = difference(result["T_base_sensor"], self.true_pose)
                print(f"{options}: off by {mm:.1f} mm, {mrad:.1f} mrad")
                self.assertEqual(result["verdict"], "uncertain")
                self.assertLessEqual({"paper_method", "first_view_only"}, self.codes(result))
                self.assertLess(mm, 38)  # 21.88 mm for each axis is the largest published error
                self.assertLess(mrad, 40)  # and 0.023 rad for each angle

    def test_a_region_without_the_robot_gives_no_pose(self):
        result = self.result("--roi", "-1,-1,4,1,1,5")
        self.assertEqual((result["verdict"], self.codes(result)), ("rejected", {"robot_not_found"}))
        self.assertNotIn("T_base_sensor", result)

    def test_options_that_cannot_be_used_are_refused(self):
        for options, word in ((("--method", "paper", "--roi", "1,2,3"), "1,2,3"), (("--roi", AROUND), "--method paper"),
                              (("--sampling", "uniform"), "--method paper")):
            with self.subTest(options):
                ended = self.calibrate(*options)
                self.assertEqual((ended.returncode, ended.stdout), (2, ""))
                self.assertIn(word, ended.stderr)

    def test_a_program_without_the_shared_object_says_so_and_calibrates_in_full(self):
        alone = self.folder / "bin/calibrd"
        alone.parent.mkdir()
        shutil.copy(BIN / "calibrd", alone)
        result = self.result(program=alone)
        self.assertEqual(self.codes(result), {"pcl_missing"})
        self.assertIn("lib/calibrd/libcalibrd_pcl.so", result["reasons"][0]["text"])
        self.assertEqual(self.calibrate(program=alone).returncode, 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
