#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The first of the kills of scripts/faults.sh kills."""

import unittest

import kills
from cell import CellTest


class FewKills(CellTest):
    def test_what_was_reported_as_stored_is_there_after_every_kill(self):
        kills.run(self, kills=8, seed=7)


if __name__ == "__main__":
    unittest.main(verbosity=2)
