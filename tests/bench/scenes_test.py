#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""One scene through `calibrd-bench scenes`, from the options to the table.
usage: scenes_test.py CALIBRD_BENCH URDF REPOSITORY"""
import json
import math
import subprocess
import sys
import unittest
from pathlib import Path

REPOSITORY, URDF, BENCH = Path(sys.argv.pop()), sys.argv.pop(), sys.argv.pop()


def bench(*options):
    return subprocess.run([BENCH, "scenes", "--robot", URDF, *options], capture_output=True, text=True, check=False)


def scene(*options):
    done = bench("--first-seed", "3", "--scenes", "1", *options)
    assert done.returncode == 0, done.stderr
    return done.stdout, [json.loads(line) for line in done.stdout.splitlines()]


class Scenes(unittest.TestCase):
    def test_one_scene_from_a_guess_to_the_table(self):
        text, lines = scene("--level", "field", "--postures", "1,2,1", "--guess-mm", "20", "--guess-deg", "2")
        self.assertEqual([(line["seed"], line["K"], line["level"]) for line in lines], [(3, 2, "field"), (3, 1, "field")])
        both = lines[0]
        self.assertEqual(both["verdict"], "accepted")
        self.assertLess(both["as_reported_mm"], 10)
        self.assertLess(both["check_points_mm"], 10)
        self.assertGreater(both["robot_pixels"], 3000)
        self.assertAlmostEqual(math.hypot(*both["axes_mm"]), both["error_mm"])
        self.assertAlmostEqual(math.hypot(*both["sensor_axes_mm"]), both["error_mm"])
        self.assertAlmostEqual(math.hypot(*both["axes_mrad"]), both["error_mrad"])
        self.assertEqual(both["inside95"], both["nees"] <= 12.592)
        table = subprocess.run([sys.executable, "-B", REPOSITORY / "scripts/scenes_table.py"], input=text,
                               capture_output=True, text=True, check=True).stdout
        self.assertIn("seeds 3..3, for tuning", table)
        self.assertIn("wrong yet accepted: 0 of", table)

    def test_same_seed_same_result_whatever_the_jobs(self):
        options = ("--first-seed", "3", "--scenes", "2", "--level", "clean", "--postures", "1", "--guess-mm", "5")
        runs = [[json.loads(line) for line in bench(*options, "--jobs", jobs).stdout.splitlines()] for jobs in "12"]
        self.assertEqual([line["seed"] for line in runs[1]], [3, 4])
        for key in ("verdict", "distance_m", "robot_pixels", "as_reported_mm"):
            self.assertEqual([line.get(key) for line in runs[0]], [line.get(key) for line in runs[1]], key)

    def test_bound_comes_with_noise_and_depth_alone(self):
        _, lines = scene("--noise-only", "--depth-only", "--bound", "--postures", "1", "--guess-mm", "5")
        self.assertEqual(lines[0]["level"], "clean")
        self.assertGreater(lines[0]["bound_known_mm"], 0)
        self.assertGreater(lines[0]["bound_free_mm"], lines[0]["bound_known_mm"])
        refused = bench("--bound")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--noise-only", refused.stderr)


if __name__ == "__main__":
    unittest.main()
