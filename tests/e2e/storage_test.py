#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Disks that are full, read-only or damaged: the last good pose is served, everything says what is wrong, and the daemon
goes on by itself. Mounts small disks of its own where it may (as root, in a namespace of its own)."""

import contextlib
import ctypes
import os
import subprocess
import tarfile
import unittest
from pathlib import Path

from cell import BIN, SENSOR, CellTest, Daemon, call, wait_until

CLONE_NEWNS = 0x00020000


def own_mounts() -> bool:
    """Mounts of this process are seen by nobody else."""
    if os.geteuid() != 0 or ctypes.CDLL(None, use_errno=True).unshare(CLONE_NEWNS) != 0:
        return False
    return subprocess.run(["mount", "--make-rprivate", "/"], capture_output=True).returncode == 0


MAY_MOUNT = own_mounts()


class StorageCase(CellTest):
    def setUp(self):
        super().setUp()
        self.simulator = self.simulate()
        self.simulator.hurry()
        self.disk = self.folder / "disk"
        self.disk.mkdir()
        self.database = self.disk / "calibrd.db"

    def mount(self, size: str) -> None:
        if not MAY_MOUNT:
            self.skipTest("mounting is for root")
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", self.disk], check=True)
        self.addCleanup(subprocess.run, ["umount", "-l", self.disk], check=True)

    def remount(self, how: str) -> None:
        subprocess.run(["mount", "-o", f"remount,{how}", self.disk], check=True)

    def start(self, *settings: str) -> Daemon:
        return self.serve(self.simulator, f"storage.path={self.database}", "drift.healing=off", *settings).wait_alive()

    def storage(self, daemon: Daemon) -> dict:
        return next(d for d in daemon.get("/readyz?verbose").json()["dependencies"] if d["name"] == "storage")

    def wait_storage(self, daemon: Daemon, state: str) -> dict:
        found = wait_until(f"the storage is {state}", lambda: s if (s := self.storage(daemon))["state"] == state else None)
        print(f"storage: {found}")
        if state != "good":
            self.assertGreater(len(found["reason"]), 40)
        return found

    def calibrate(self, daemon: Daemon) -> str:
        job = daemon.calibrate(postures=2)
        self.assertEqual(job["status"], "succeeded", job["message"])
        wait_until("the pose is valid", lambda: daemon.pose()["valid"])
        return job["id"]

    def expect_pose_of(self, daemon: Daemon, calibration: str) -> None:
        """It is known at once, and valid again as soon as a check has agreed."""
        pose = daemon.pose()
        self.assertEqual((pose.get("last_known") or pose)["calibration"], calibration)
        wait_until("the pose is valid", lambda: (p := daemon.pose())["valid"] and p["calibration"] == calibration)

    def expect_refused(self, daemon: Daemon, *words: str) -> None:
        answer = call(daemon.port, "POST", f"/api/v1/sensors/{SENSOR}/calibrations", {"postures": 2})
        self.assertEqual((answer.status, answer.json()["code"]), (500, "storage_failed"))
        print(answer.json()["detail"])
        for word in words:
            self.assertIn(word, answer.json()["detail"])


class Disks(StorageCase):
    def fill(self, name: str = "filler") -> Path:
        filler = self.disk / name
        with filler.open("wb", buffering=0) as stream, contextlib.suppress(OSError):
            while stream.write(b"x" * 4096):
                pass
        return filler

    def test_a_full_disk(self):
        self.mount("40m")
        daemon = self.start("storage.captures_max_mb=0")
        first = self.calibrate(daemon)
        filler = self.fill()
        self.wait_storage(daemon, "full")
        self.expect_refused(daemon, "full", "room")
        self.expect_pose_of(daemon, first)

        daemon.stop()
        self.fill("what its journal took")
        daemon = self.start("storage.captures_max_mb=0")  # a start with no room at all
        self.wait_storage(daemon, "full")
        self.expect_pose_of(daemon, first)
        self.expect_refused(daemon, "full")
        self.assertTrue((self.disk / f"calibrd.db.last/{SENSOR}.json").exists(), "nothing replaces it")

        filler.unlink()
        self.wait_storage(daemon, "good")
        second = self.calibrate(daemon)
        listed = [c["id"] for c in daemon.json(f"/api/v1/sensors/{SENSOR}/calibrations")["calibrations"]]
        self.assertEqual(listed, [second, first])

    def test_a_disk_that_fills_while_it_calibrates(self):
        self.mount("40m")
        daemon = self.start("storage.captures_max_mb=0")
        first = self.calibrate(daemon)
        location = daemon.start_calibration(postures=2)
        filler = self.fill()
        job = daemon.wait_calibration(location)
        print(job["message"])
        if job["status"] == "succeeded":
            self.skipTest("SQLite's journal had room left for it")
        self.assertIn("could not be stored", job["message"])
        self.assertIn("full", job["message"])
        self.expect_pose_of(daemon, first)
        filler.unlink()
        self.wait_storage(daemon, "good")
        daemon.stop()
        daemon = self.start()
        self.assertEqual(daemon.json(location)["message"], job["message"], "it was stored once there was room")

    def test_a_read_only_disk(self):
        self.mount("100m")
        daemon = self.start()
        first = self.calibrate(daemon)
        daemon.stop()
        self.remount("ro")
        daemon = self.start()
        self.wait_storage(daemon, "read_only")
        self.expect_pose_of(daemon, first)
        self.expect_refused(daemon, "read-only")
        self.remount("rw")
        self.wait_storage(daemon, "good")
        self.expect_pose_of(daemon, first)
        self.calibrate(daemon)


class Damage(StorageCase):
    def test_a_damaged_database_is_put_aside_and_the_pose_is_served(self):
        daemon = self.start()
        first = self.calibrate(daemon)
        daemon.stop()
        with self.database.open("r+b") as stream:
            stream.seek(4096)
            stream.write(os.urandom(5 * 4096))
        daemon = self.start()
        pose = daemon.pose()
        self.assertFalse(pose["valid"] and pose["state"] != "calibrated")
        found = self.wait_storage(daemon, "recovered")
        aside = list(self.disk.glob("calibrd.db.damaged-*"))
        self.assertEqual(len(aside), 1)
        self.assertIn(str(aside[0]), found["reason"])
        self.assertIn(str(aside[0]), daemon.output())
        self.expect_pose_of(daemon, first)
        aside[0].unlink()
        self.wait_storage(daemon, "good")
        self.calibrate(daemon)


class Evidence(StorageCase):
    def test_a_calibration_is_made_again_from_what_is_kept_of_it(self):
        daemon = self.start()
        job = daemon.json(f"/api/v1/calibrations/{self.calibrate(daemon)}")
        evidence = job["evidence"]
        self.assertIn("[robot]", evidence["configuration"])
        self.assertEqual(evidence["software_version"], daemon.json("/api/v1/cell")["version"])
        self.assertEqual(len(evidence["views"]), job["result"]["views"])
        self.assertEqual(len(evidence["views"][0]["joint_positions_rad"]), len(evidence["joint_names"]))
        capture = wait_until("its views are kept", lambda: daemon.json(f"/api/v1/calibrations/{job['id']}")["evidence"]["capture"])
        answer = daemon.get(capture["path"])
        self.assertEqual((answer.status, len(answer.body)), (200, capture["bytes"]))
        (self.folder / "views.tar").write_bytes(answer.body)
        with tarfile.open(self.folder / "views.tar") as archive:
            archive.extractall(self.folder / "views")
        recording = next((self.folder / "views").iterdir())
        again = subprocess.run([BIN / "calibrd", "calibrate", recording], capture_output=True, text=True)
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)

        next(self.disk.glob("captures/*.tar")).unlink()
        dropped = daemon.get(capture["path"])
        self.assertEqual((dropped.status, dropped.json()["code"]), (404, "capture_not_kept"))
        self.assertIsNone(daemon.json(f"/api/v1/calibrations/{job['id']}")["evidence"]["capture"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
