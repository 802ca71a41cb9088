#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""A daemon started by root goes on as another user: after it has its port and its key, for good."""

import os
import pwd
import re
import subprocess
import unittest

from cell import BIN, OF_THIS_BUILD, SOURCE, CellTest, Daemon, wait_until

USER = "nobody"


@unittest.skipUnless(os.geteuid() == 0, "only root can become somebody else")
class RunAs(CellTest):
    def status(self, pid: int) -> dict[str, str]:
        lines = open(f"/proc/{pid}/status", encoding="utf-8").read().splitlines()
        return dict(line.split(":\t", 1) for line in lines if ":\t" in line)

    def test_every_thread_is_the_user_without_a_way_back(self):
        user = pwd.getpwnam(USER)
        os.chown(self.folder, user.pw_uid, user.pw_gid)
        self.folder.chmod(0o700)
        simulator = self.simulate()
        daemon = self.serve(simulator, f"server.run_as={USER}").wait_alive()
        wait_until("robot and sensor are up", lambda: daemon.get("/readyz").status == 200)
        for task in os.listdir(f"/proc/{daemon.process.pid}/task"):
            status = self.status(int(task))
            self.assertEqual(set(status["Uid"].split()), {str(user.pw_uid)}, status["Name"])
            self.assertEqual(set(status["Gid"].split()), {str(user.pw_gid)}, status["Name"])
            self.assertEqual(int(status["CapEff"], 16), 0)
            self.assertEqual(status["NoNewPrivs"], "1", status["Name"])
            self.assertNotIn("0", status["Groups"].split())
        self.assertEqual((self.folder / "calibrd.db").stat().st_uid, user.pw_uid)
        children = subprocess.run(["ps", "-o", "uid=", "--ppid", str(daemon.process.pid)], capture_output=True, text=True, check=False)
        self.assertEqual(set(re.findall(r"\d+", children.stdout)), {str(user.pw_uid)}, "the sensor's process")

    def refused(self, *settings: str, as_user: int | None = None) -> str:
        own = (f"storage.path={self.folder / 'calibrd.db'}", "server.port=0", "robot.port=9", *OF_THIS_BUILD)
        options = [word for setting in (*own, *settings) for word in ("--set", setting)]
        ended = subprocess.run([BIN / "calibrd", "serve", "--config", SOURCE / "config/demo.toml", *options], cwd="/", user=as_user,
                               timeout=20, capture_output=True, text=True, check=False)
        self.assertEqual(ended.returncode, 2, ended.stderr)
        return ended.stderr

    def test_it_does_not_start_when_it_cannot(self):
        self.assertIn("no-such-user", self.refused("server.run_as=no-such-user"))
        self.assertIn("root", self.refused("server.run_as=root", as_user=pwd.getpwnam(USER).pw_uid))


if __name__ == "__main__":
    unittest.main()
