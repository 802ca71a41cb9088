#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The first of the losses of scripts/faults.sh disconnects, and the pause that a controller's eviction costs."""

import time
import unittest

import disconnects
from cell import SLOWNESS, CellTest, wait_until
from flaky_wire import FlakyWire

# A machine that is busy otherwise needs longer to start a sensor process; that nothing grows needs many times to show.
WITHIN_S = 3.0


class FewDisconnects(CellTest):
    def test_both_are_back_soon_and_nothing_is_left_open(self):
        slowest, grown = disconnects.run(self, times=6, seed=7, warm_up=6)
        self.assertLessEqual(slowest, WITHIN_S * SLOWNESS)
        self.assertLessEqual(grown["descriptors"], 0)
        self.assertLessEqual(grown["threads"], 0)

    def test_two_quick_evictions_are_a_reason_to_stay_away(self):
        wire = FlakyWire(self.simulate())
        self.addCleanup(wire.close)
        daemon = self.serve(wire, "robot.link.eviction_pause=4s")
        for times in (1, 2):
            wait_until("joints come", lambda: (link := daemon.robot()["link"])["state"] == "streaming" and link["connects"] == times,
                       period_s=0.01)
            wire.break_("fin")
            wire.mend()
        robot = wait_until("it says so", lambda: r if (r := daemon.robot()["link"])["state"] == "faulted" else None, period_s=0.01)
        begin, accepted = time.monotonic(), wire.accepted
        self.assertIn("slot", robot["reason"])
        wait_until("joints come again", lambda: daemon.robot()["link"]["state"] == "streaming", period_s=0.01)
        self.assertGreater(time.monotonic() - begin, 3.5)
        self.assertEqual(wire.accepted, accepted + 1, "meanwhile it did not try")


if __name__ == "__main__":
    unittest.main(verbosity=2)
