# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Reads the JSON lines of `calibrd-bench knocked` and prints the table of scripts/knocked.sh.

usage: knocked_table.py LINES    (wrong: beyond 2 mm or 2 mrad, and accepted)
"""
import json
import sys

WRONG_MM, WRONG_MRAD = 2.0, 2.0


def is_wrong(run):
    return run.get("error_mm", 0) > WRONG_MM or run.get("error_mrad", 0) > WRONG_MRAD


def row(name, runs):
    accepted = [run for run in runs if run["verdict"] == "accepted"]
    found = [run for run in accepted if run["found"]]
    wrong = [run for run in accepted if is_wrong(run)]
    served = [run for run in wrong if not run["found"]]
    largest = max((run["error_mm"] for run in accepted if not run["found"]), default=0)
    squares = [max((run[kind] for run in accepted), default=0) for kind in ("background_squares", "robot_squares")]
    print(f"{name:12s} {len(runs):6d} {len(accepted):9d} {len(found):10d} {len(wrong):6d} {len(served):13d} {largest:11.2f} "
          f"{squares[0]:11.1f} {squares[1]:6.1f}")


scenes = [json.loads(line) for line in open(sys.argv[1])]
scenes = [scene for scene in scenes if "still" in scene]
print(f"{'':12s} {'scenes':>6s} {'accepted':>9s} {'found out':>10s} {'wrong':>6s} {'wrong, served':>13s} {'largest mm':>11s} "
      f"{'background':>11s} {'robot':>6s}")
row("undisturbed", [scene["still"] for scene in scenes])
for kind in ("slide", "turn", "both"):
    row(kind, [scene["knocked"] for scene in scenes if scene["kind"] == kind])
