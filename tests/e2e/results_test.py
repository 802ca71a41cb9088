#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/results.sh repeats the paper's experiment and draws it; its errors are what they are called."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from cell import BUILD, SOURCE
from poses import axis_turn, multiply, shift

sys.path.insert(0, str(SOURCE / "scripts"))
from results_run import GUESS_M, GUESS_RAD, error_of, from_rpy, guess_near, to_rpy  # noqa: E402

TRUTH = multiply(shift((1.3, -0.2, 0.7)), axis_turn((1, 2, 3), 2.1))


class Errors(unittest.TestCase):
    def test_position_is_along_the_axes_of_the_base(self):
        position_mm, angle_rad = error_of(multiply(shift((0.001, -0.002, 0.003)), TRUTH), TRUTH)
        for value, expected in zip(position_mm + angle_rad, (1, -2, 3, 0, 0, 0)):
            self.assertAlmostEqual(value, expected, places=9)

    def test_angles_are_those_of_the_turn_from_the_truth_about_the_axes_of_the_base(self):
        for axis in range(3):
            direction = tuple(float(i == axis) for i in range(3))
            _, angle_rad = error_of(multiply(axis_turn(direction, 0.02), TRUTH), TRUTH)
            for value, expected in zip(angle_rad, direction):
                self.assertAlmostEqual(value, 0.02 * expected, places=9)

    def test_angles_make_the_turn_they_come_from(self):
        for value, expected in zip(to_rpy(from_rpy(0.3, -0.2, 1.1)), (0.3, -0.2, 1.1)):
            self.assertAlmostEqual(value, expected, places=9)

    def test_guesses_are_off_by_no_more_than_is_stated(self):
        for seed in range(50):
            position_mm, angle_rad = error_of(guess_near(TRUTH, seed), TRUTH)
            self.assertLessEqual(max(map(abs, position_mm)), 1e3 * GUESS_M + 1e-6)
            self.assertLessEqual(max(map(abs, angle_rad)), GUESS_RAD + 1e-9)
            self.assertGreater(max(map(abs, position_mm)), 1)


class Experiment(unittest.TestCase):
    def test_one_command_makes_tables_and_figures(self):
        with tempfile.TemporaryDirectory() as name:
            docs, kept = Path(name, "docs"), Path(name, "kept")
            docs.mkdir()
            shutil.copy(SOURCE / "docs/results.md", docs)
            environment = {key: value for key, value in os.environ.items() if key != "CALIBRD_SHARED_DATA"}
            subprocess.run([shutil.which("bash"), SOURCE / "scripts/results.sh", "--repetitions", "1", "--first-seed", "1",
                            "--docs", docs, "--keep", kept], check=True, env={**environment, "CALIBRD_PRESET": BUILD.name})
            for level in ("clean", "cell"):
                lines = [json.loads(line) for line in (kept / f"arm7_{level}.jsonl").read_text().splitlines()]
                self.assertEqual(sorted((line["method"], line["posture"]) for line in lines),
                                 [("full", "1"), ("full", "2"), ("full", "both"), ("paper", "1"), ("paper", "2"),
                                  ("paper, three sensors", "1"), ("paper, three sensors", "2")])
                for figure in ("axes", "angles"):
                    picture = ElementTree.parse(docs / f"results/arm7_{level}_{figure}.svg")
                    marks = picture.findall(".//{*}circle") + picture.findall(".//{*}path")
                    posed = sum("angle_rad" in line for line in lines if line["method"] != "paper, three sensors")
                    self.assertEqual(len(marks), 3 * posed + 3)  # and three of the legend
            rows = (docs / "results.md").read_text().count("| paper's method, one posture, guess | 2 of 2 |")
            self.assertEqual(rows, 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
