# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Reads one JSON line of `calibrd-bench register` and prints its row of the table of scripts/pairs.sh.

usage: pairs_row.py PAIR_DIR < line    (PAIR_DIR holds source.ply and truth.txt: 3x4 or 4x4, target from source)
"""
import array
import json
import math
import pathlib
import sys


def points_of(ply):
    """The points of a binary little-endian PLY file whose vertices are float x, y, z and nothing else."""
    header, _, body = ply.read_bytes().partition(b"end_header\n")
    floats = array.array("f", body[: 12 * int(header.split(b"element vertex ")[1].split()[0])])
    if sys.byteorder == "big":
        floats.byteswap()
    return list(zip(floats[0::3], floats[1::3], floats[2::3]))


def applied(transform, point):
    return [sum(row[i] * point[i] for i in range(3)) + row[3] for row in transform[:3]]


folder = pathlib.Path(sys.argv[1])
found = json.load(sys.stdin)
truth = [[float(number) for number in line.split()] for line in (folder / "truth.txt").read_text().splitlines()]
points = points_of(folder / "source.ply")
squares = sum(math.dist(applied(truth, p), applied(found["T_target_source"], p)) ** 2 for p in points)
print(f'{folder.name:12s} {found["median_ms"]:10.2f} {found["least_ms"]:10.2f} {1e3 * math.sqrt(squares / len(points)):10.4f} '
      f'{found["iterations"]:6d} {found["overlap"]:8.3f}')
