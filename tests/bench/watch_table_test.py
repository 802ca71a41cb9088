#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""What scripts/watch_table.py makes of the lines of the watch's benchmarks. usage: watch_table_test.py REPOSITORY"""
import json
import math
import random
import subprocess
import sys
import unittest
from pathlib import Path

TABLE = Path(sys.argv.pop()) / "scripts/watch_table.py"


def event(seed, staged, said=None, frames=5, **others):
    line = {"seed": seed, "robot": "arm", "event": staged, "what": "it", "moved_mm": 0.0, "turned_mrad": 0.0,
            "verdict": said or staged, "last": said or staged, "before": "in_place", "frames_to_verdict": frames,
            "ms_median": 1.0, "ms_99": 1.5, "seconds": {}}
    return line | others


def printed(lines):
    text = "".join(json.dumps(line) + "\n" for line in lines)
    return subprocess.run([sys.executable, "-B", TABLE], input=text, capture_output=True, text=True, check=False)


class Table(unittest.TestCase):
    def test_counts_what_is_right_and_shows_what_is_not(self):
        text = printed([event(300001, "in_place"), event(300002, "dark", "no_evidence") | {"event": "no_evidence"},
                        event(300003, "scene_changed", "in_place"), event(300004, "scene_changed")]).stdout
        self.assertIn("4 events, seeds 300001..300004, for the report; right: 3 (75.0 %)", text)
        self.assertIn("seed 300003 arm: it: in_place", text)
        self.assertNotIn("seed 300004", text)

    def test_tells_missed_moves_and_false_ones(self):
        text = printed([event(1, "sensor_moved", "in_place", -1), event(2, "sensor_moved"),
                        event(3, "in_place", "sensor_moved"),
                        event(4, "dark", before="sensor_moved") | {"event": "no_evidence"}]).stdout
        self.assertIn("moved, missed: 1 of 2; said to have moved though it stood: 2", text)
        self.assertIn("for tuning", text)

    def test_small_moves_have_a_figure_of_their_own(self):
        moves = [event(n, "sensor_moved", frames=n, moved_mm=4.0, turned_mrad=5.0) for n in range(1, 21)]
        moves.append(event(30, "sensor_moved", frames=99, moved_mm=20.0))
        text = printed(moves).stdout
        self.assertIn("all moves: 21, found 21, frames median / 95 % / most: 11 / 20 / 99", text)
        self.assertIn("6 mrad: 20, found 20, frames median / 95 % / most: 10 / 19 / 20", text)

    def test_creep_that_was_not_found_is_said_so(self):
        lines = [{"seed": 300001 + n, "robot": "arm", "turns": n == 1, "found": n < 2, "at": 0.5 + n, "sigma_mm": 0.4,
                  "sigma_mrad": 0.1, "offset_mm": 6.9, "frames": 30} for n in range(3)]
        text = printed(lines).stdout
        self.assertIn("3 sensors that creep, seeds 300001..300003, for the report: found 2", text)
        self.assertIn("median / most: 0.50 / 1.50", text)
        self.assertIn("shifted 2.50 mm, NOT FOUND", text)

    def test_hours_add_up(self):
        cell = {"seed": 300001, "robot": "arm", "frames": 54000, "with_evidence": 5, "false_alarms": 1, "largest": 3.0,
                "threshold": 10.7, "scene_changes": 4, "ms_median": 1.0, "ms_99": 1.4, "seconds": {"in_place": 1800},
                "unseen_s": 1.5, "robot_doubt": 0.3, "creep_doubt": 0.1, "checks": 500}
        text = printed([cell, cell | {"seed": 300002, "false_alarms": 0, "largest": 4.5}]).stdout
        self.assertIn("nothing showed that the sensor stands: 3.0 s", text)
        self.assertIn("at most: 0.30 in postures one by one, 0.10 in their mean; comparisons: 1000", text)
        self.assertIn("108000 frames = 1.00 h, 8 changes of the scene; false alarms: 1; largest statistic 4.50 of 10.70",
                      text)

    def test_tail_of_known_peaks(self):
        source, scale = random.Random(3), 0.5
        blocks = [{"cell": 1, "frames": 1800,
                   "tails": [{"tolerance_share": 1.0, "peaks": [1 + source.expovariate(1 / scale) for _ in range(50)]}]}
                  for _ in range(60)]
        drawn = {"resampled_h": 72.0, "blocks": 60, "block_s": 60.0, "alarms": 0, "largest": 6.0, "threshold": 10.0}
        text = printed(blocks + [drawn]).stdout
        years = 60 * 60 / 3000 * math.exp(9 / scale) / (365.25 * 86400)
        told = float(text.split("peaks, largest ")[1].split(": ")[1].split(" years")[0])
        low, high = (float(word) for word in text.split("blocks: ")[1].split(" years")[0].split(" to "))
        self.assertLess(abs(math.log(told / years)), 2.5)
        self.assertLess(low, years)
        self.assertGreater(high, years)
        self.assertIn("72 h drawn from 60 blocks of 60 s: 0 alarms", text)

    def test_nothing_to_read_is_an_error(self):
        self.assertNotEqual(printed([]).returncode, 0)


if __name__ == "__main__":
    unittest.main()
