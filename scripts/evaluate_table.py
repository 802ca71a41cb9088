#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Reads what `calibrd-bench fine` prints: `row NAME` one line of a table, `spread` how far poses lie apart,
`poses` lines for the judge."""
import json
import math
import sys


def runs():
    return [run for run in map(json.loads, sys.stdin) if "verdict" in run]


def row(name):
    run = runs()[0]
    print(f"{name:14} {run['verdict']:10} error {run['error_mm']:7.3f} mm {run['error_mrad']:7.3f} mrad   "
          f"sigma {run['sigma_mm']:7.3f} mm {run['sigma_mrad']:7.3f} mrad   coverage {run['coverage']:.2f}   "
          f"{run['ms']:6.0f} ms   {','.join(run['reasons'])}")


def apart(a, b):
    """Distance in mm and angle in mrad between two row-major 4x4 poses."""
    shift = math.dist([a[3], a[7], a[11]], [b[3], b[7], b[11]])
    trace = sum(a[4 * i + k] * b[4 * i + k] for i in range(3) for k in range(3))
    # From the Frobenius norm of the difference, which stays exact for small angles where acos does not.
    squared = sum((a[4 * i + k] - b[4 * i + k]) ** 2 for i in range(3) for k in range(3))
    angle = 2 * math.asin(min(1.0, math.sqrt(squared / 8))) if trace > -1 else math.pi
    return 1e3 * shift, 1e3 * angle


def spread():
    results = runs()
    poses = [run["T_base_sensor"] for run in results if "T_base_sensor" in run]
    pairs = [apart(a, b) for i, a in enumerate(poses) for b in poses[:i]]
    verdicts = [run["verdict"] for run in results]
    print(f"{len(results)} runs, {len(poses)} poses, {verdicts.count('accepted')} accepted; furthest apart: "
          f"{max(p[0] for p in pairs):.3f} mm, {max(p[1] for p in pairs):.3f} mrad")


def poses():
    for i, run in enumerate(runs()):
        if "T_base_sensor" in run:
            print(f"guess_{i:02}", *run["T_base_sensor"][:12])


if __name__ == "__main__":
    {"row": lambda: row(sys.argv[2]), "spread": spread, "poses": poses}[sys.argv[1]]()
