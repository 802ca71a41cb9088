#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Holds scripts/scenes_table.py against made-up runs whose counts are known.
usage: scenes_table_test.py REPOSITORY"""
import json
import subprocess
import sys
import unittest
from pathlib import Path

TABLE = Path(sys.argv.pop(1)) / "scripts" / "scenes_table.py"


def run(seed, verdict="accepted", mm=1.0, mrad=0.5, **others):
    line = {"seed": seed, "robot": "arm", "level": "cell", "depth_only": False, "jobs": 1, "K": 4, "verdict": verdict,
            "reasons": [] if verdict == "accepted" else ["low_coverage"], "time_ms": 100.0 + seed % 10}
    if verdict != "rejected":
        line |= {"error_mm": mm, "error_mrad": mrad, "as_reported_mm": mm, "as_reported_mrad": mrad,
                 "check_points_mm": mm, "nees": 6.0, "inside95": True, "sigma_position_mm": 0.4,
                 "sigma_rotation_mrad": 0.3}
    return line | others


def printed(lines, *options):
    text = "".join(json.dumps(line) + "\n" for line in lines)
    done = subprocess.run([sys.executable, "-B", TABLE, *options], input=text, capture_output=True, text=True, check=False)
    return done


def cells(text, name, views):
    """The cells of a row, by their heads; the heads stand in the table's first row."""
    rows = [[cell.strip() for cell in line.split("  ") if cell.strip()] for line in text.splitlines()]
    head = next(row for row in rows if row[:2] == ["K", "scenes"])
    row = next(row for row in rows if row[:2] == [name, str(views)])
    return dict(zip(head, row[1:]))


class Table(unittest.TestCase):
    def test_counts_shares(self):
        runs = [run(100001), run(100002, mm=4.0), run(100003, mm=7.0), run(100004, "uncertain", mm=50.0),
                run(100005, "rejected")]
        row = cells(printed(runs).stdout, "all", 4)
        self.assertEqual((row["scenes"], row["accepted"], row["good"], row["WRONG"]), ("5", "60.0 %", "40.0 %", "0"))
        self.assertEqual(row["mm"], "4.00 / 7.00")  # of the accepted ones alone
        self.assertEqual(row["ms"], "103 / 105")    # of all

    def test_shows_what_is_wrong_yet_accepted(self):
        for seed, fault in ((7, {"mm": 10.5}), (8, {"mrad": 10.5}), (9, {"check_points_mm": 10.5})):
            text = printed([run(1), run(seed, **fault)]).stdout
            self.assertEqual(cells(text, "all", 4)["WRONG"], "1")
            self.assertIn("wrong yet accepted: 1 of 2 accepted\n  seed %d K 4 cell arm:" % seed, text)

    def test_not_a_number_is_not_within_bounds(self):
        row = cells(printed([run(1, mm=float("nan"))]).stdout, "all", 4)
        self.assertEqual((row["good"], row["WRONG"]), ("0.0 %", "1"))

    def test_uncertain_is_never_wrong(self):
        self.assertIn("wrong yet accepted: 0 of 0", printed([run(1, "uncertain", mm=90.0)]).stdout)

    def test_consistency_is_of_the_accepted(self):
        runs = [run(1, nees=3.0), run(2, nees=21.0, inside95=False), run(3, "uncertain", nees=600.0, inside95=False)]
        row = cells(printed(runs).stdout, "all", 4)
        self.assertEqual((row["in 95 %"], row["NEES/6"]), ("50.0 %", "2.00"))

    def test_keeps_views_levels_and_robots_apart(self):
        text = printed([run(1), run(2, K=10, robot="other"), run(3, level="field", mm=30.0)]).stdout
        self.assertEqual(cells(text, "all", 10)["scenes"], "1")
        self.assertEqual(cells(text, "all", 4)["scenes"], "2")
        self.assertEqual(cells(text, "cell", 4)["WRONG"], "0")
        self.assertEqual(cells(text, "field", 4)["WRONG"], "1")
        self.assertEqual(cells(text, "other", 10)["scenes"], "1")

    def test_names_the_seeds_and_their_kind(self):
        self.assertIn("seeds 5..999, for tuning", printed([run(5), run(999)]).stdout)
        self.assertIn("seeds 100001..100001, for the report", printed([run(100001)]).stdout)
        self.assertIn("NEITHER", printed([run(999), run(100001)]).stdout)

    def test_says_when_times_are_no_figure_and_why_not_accepted(self):
        text = printed([run(1, "rejected", jobs=2)]).stdout
        self.assertIn("TIMES ARE NOT THE FIGURE", text)
        self.assertIn("not accepted, K 4: rejected:low_coverage 1", text)

    def test_scene_that_could_not_be_simulated_is_no_scene(self):
        text = printed([run(1), {"seed": 2, "robot": "arm", "level": "cell", "depth_only": False, "jobs": 1,
                                 "error": "no view"}]).stdout
        self.assertEqual(cells(text, "all", 4)["scenes"], "1")
        self.assertIn("not simulated: 1 scenes, seeds 2", text)

    def test_nothing_to_read_and_a_scene_read_twice_are_errors(self):
        self.assertNotEqual(printed([]).returncode, 0)
        twice = printed([run(1), run(2), run(1)])
        self.assertNotEqual(twice.returncode, 0)
        self.assertIn("seed 1 with K 4", twice.stderr)

    def test_bound_is_a_ratio_of_root_mean_squares(self):
        bounds = {"bound_known_mm": 1.0, "bound_known_mrad": 0.1, "bound_free_mm": 2.5, "bound_free_mrad": 0.2}
        text = printed([run(1, mm=3.0, mrad=0.4, **bounds), run(2, "uncertain", mm=4.0, mrad=0.4, **bounds)],
                       "--bound").stdout
        row = next(line.split() for line in text.splitlines() if line.startswith("position mm"))
        self.assertEqual(row[2:], ["4", "2", "3.5355", "1.0000", "3.54", "2.5000", "1.41"])


if __name__ == "__main__":
    unittest.main()
