#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Kills the daemon (SIGKILL) at random moments of its calibrations, again and again, and checks after each restart that
everything it had reported as stored is there.

usage: kills.py [KILLS] [SEED]
"""

import contextlib
import http.client
import random
import shutil
import sqlite3
import sys
import time
import unittest
from pathlib import Path

from cell import CellTest, Daemon, wait_until

LONGEST_LIFE_S = 8.0
STARTS_WITHIN_S = 120.0  # on a machine that is busy otherwise
NEAR_ITS_END_S = 1.0  # one half of the kills come so soon after a calibration is computed: while it is stored, or just after
ENDED = ("succeeded", "failed", "cancelled")


class Killed:
    """A store whose daemons are killed, and what they had said before."""

    def __init__(self, test: CellTest, seed: int):
        self.test, self.random = test, random.Random(seed)
        self.simulator = test.simulate()
        self.simulator.hurry()
        self.start_pose = self.simulator.true_pose()
        self.asked: set[str] = set()          # calibrations that were accepted for work
        self.ended: dict[str, str] = {}       # id: status, as reported
        self.current, self.under_way = "", ""  # by the last report; what may have become so since
        self.kills = self.during_a_calibration = 0
        self.kill_at, self.waits_for_end = 0.0, False

    def live(self) -> None:
        """One life: calibrations one after the other, until it is killed."""
        daemon = self.test.serve(self.simulator, "drift.healing=off", "storage.captures_max_mb=20")
        wait_until("the daemon answers", lambda: daemon.get("/livez").status == 200, STARTS_WITHIN_S)
        self.check(daemon)
        self.kill_at = time.monotonic() + self.random.uniform(0.05, LONGEST_LIFE_S)
        self.waits_for_end = self.random.random() < 0.5
        if self.waits_for_end:
            self.kill_at += 60
        with contextlib.suppress(OSError, http.client.HTTPException):
            while time.monotonic() < self.kill_at:
                self.calibrate(daemon)
        daemon.process.kill()
        daemon.process.wait()
        self.kills += 1
        self.during_a_calibration += bool(self.under_way)
        self.test.programs.remove(daemon)

    def calibrate(self, daemon: Daemon) -> None:
        location = daemon.start_calibration(postures=1, guess=self.start_pose)
        self.under_way = location.rsplit("/", 1)[1]
        self.asked.add(self.under_way)
        while time.monotonic() < self.kill_at:
            job = daemon.json(location)
            if job["status"] == "running" and self.waits_for_end:
                self.kill_at, self.waits_for_end = time.monotonic() + self.random.uniform(0, NEAR_ITS_END_S), False
            if job["status"] in ENDED:
                self.ended[job["id"]] = job["status"]
                if job["current"]:
                    self.current = job["id"]
                self.under_way = ""
                return
            time.sleep(0.01)

    def check(self, daemon: Daemon) -> None:
        """What the daemon serves after the restart, and what its database holds."""
        if not self.asked:
            return
        last = daemon.json(f"/api/v1/calibrations/{self.under_way}")["status"] if self.under_way else ""
        newest = self.under_way if last == "succeeded" else self.current
        pose = daemon.pose()
        served = (pose.get("last_known") or pose).get("calibration") if newest else None
        self.test.assertEqual(served or "", newest, f"{pose}")
        if newest:
            self.test.assertTrue(daemon.json(f"/api/v1/calibrations/{newest}")["current"])
        self.current, self.under_way = newest, ""
        self.check_database(self.test.folder / "calibrd.db")

    def check_database(self, file: Path) -> None:
        copy = self.test.folder / "copy"
        shutil.rmtree(copy, ignore_errors=True)
        copy.mkdir()
        for name in (file, Path(f"{file}-wal")):
            if name.exists():
                shutil.copy(name, copy / name.name)
        with contextlib.closing(sqlite3.connect(copy / file.name)) as database:
            self.test.assertEqual(database.execute("PRAGMA integrity_check").fetchall(), [("ok",)])
            held = dict(database.execute("SELECT c.id, r.status FROM calibrations c LEFT JOIN results r ON r.calibration_id = c.id"))
        self.test.assertLessEqual(self.asked, held.keys())
        for calibration, status in self.ended.items():
            self.test.assertEqual(held[calibration], status, calibration)
        self.test.assertFalse(list(self.test.folder.glob("*.damaged-*")), "no database is taken for damaged")


def run(test: CellTest, kills: int, seed: int) -> Killed:
    killed = Killed(test, seed)
    for _ in range(kills):
        killed.live()
        if killed.kills % 10 == 0:
            print(f"{killed.kills} kills, {len(killed.ended)} calibrations", flush=True)
    killed.check(test.serve(killed.simulator, "drift.healing=off").wait_alive())
    accepted = sum(status == "succeeded" for status in killed.ended.values())
    print(f"{killed.kills} kills with seed {seed}, {killed.during_a_calibration} of them during a calibration; {len(killed.asked)} "
          f"calibrations begun, {len(killed.ended)} reported as ended, {accepted} as accepted: all there")
    return killed


class Kills(CellTest):
    wanted, seed = 200, 1

    def test_what_was_reported_as_stored_is_there_after_every_kill(self):
        killed = run(self, self.wanted, self.seed)
        self.assertGreater(killed.during_a_calibration, 0)
        self.assertIn("succeeded", killed.ended.values())


if __name__ == "__main__":
    if len(sys.argv) > 1:
        Kills.wanted = int(sys.argv.pop(1))
    if len(sys.argv) > 1:
        Kills.seed = int(sys.argv.pop(1))
    unittest.main(verbosity=2)
