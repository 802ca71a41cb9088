#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Repeats the paper's experiment in the simulated cell: records it, calibrates it by each method, compares with truth.

Prints one JSON line per calibration. scripts/results.sh says how, docs/results.md what came out.
"""

import argparse
import json
import math
import random
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# What a person with a ruler and a protractor gets wrong: at most this, per axis, uniformly. The paper says no more than
# that its initial value was "obtained through a rough actual measurement".
GUESS_M, GUESS_RAD = 0.03, math.radians(2)
DISTANCE_M = 1.34

Matrix = list[list[float]]


def product(a: Matrix, b: Matrix) -> Matrix:
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transposed(a: Matrix) -> Matrix:
    return [list(column) for column in zip(*a)]


def rotation(T: Matrix) -> Matrix:
    return [row[:3] for row in T[:3]]


def from_rpy(roll: float, pitch: float, yaw: float) -> Matrix:
    """Rz(yaw) Ry(pitch) Rx(roll)."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    return product(product([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]], [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]),
                   [[1, 0, 0], [0, cr, -sr], [0, sr, cr]])


def to_rpy(R: Matrix) -> list[float]:
    return [math.atan2(R[2][1], R[2][2]), -math.asin(max(-1.0, min(1.0, R[2][0]))), math.atan2(R[1][0], R[0][0])]


def error_of(T: Matrix, truth: Matrix) -> tuple[list[float], list[float]]:
    """Position error (mm, base axes) and angle error (roll, pitch, yaw of the turn from truth to T, rad, base axes)."""
    return [1e3 * (T[i][3] - truth[i][3]) for i in range(3)], to_rpy(product(rotation(T), transposed(rotation(truth))))


def guess_near(truth: Matrix, seed: int) -> Matrix:
    dice = random.Random(seed)
    R = product(from_rpy(*(dice.uniform(-GUESS_RAD, GUESS_RAD) for _ in range(3))), rotation(truth))
    return [R[i] + [truth[i][3] + dice.uniform(-GUESS_M, GUESS_M)] for i in range(3)] + [[0, 0, 0, 1]]


def run(*command, accepted=(0,)) -> str:
    ended = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if ended.returncode not in accepted:
        sys.exit(f"{command[0]} {command[1]}: {ended.stderr.strip()}")
    return ended.stdout


def one_posture(capture: Path, index: int, folder: Path) -> Path:
    """A recording of one frame of another."""
    folder.mkdir()
    description = json.loads((capture / "capture.json").read_text())
    description["frames"] = [description["frames"][index]]
    for key in ("depth", "image"):
        shutil.copy(capture / description["frames"][0][key], folder)
    (folder / "capture.json").write_text(json.dumps(description))
    return folder


def repetition(options: argparse.Namespace, seed: int) -> list[dict]:
    """One cell, two postures: every method on it."""
    with tempfile.TemporaryDirectory(prefix="calibrd-results-") as name:
        folder = Path(name)
        both = folder / "both"
        run(options.bin / "calibrd-sim", "capture", both, "--urdf", options.urdf, *options.models, "--seed", seed, "--level",
            options.level, "--postures", 2, "--min-distance", DISTANCE_M, "--max-distance", DISTANCE_M)
        truth = json.loads((both / "truth.json").read_text())["T_base_sensor"]
        lines = []

        def calibrate(method: str, posture: str, capture: Path, *arguments) -> None:
            result = json.loads(run(options.bin / "calibrd", "calibrate", capture, *options.models, *arguments, accepted=(0, 3)))
            line = {"seed": seed, "method": method, "posture": posture, "verdict": result["verdict"],
                    "ms": result["time_ms"]["total"], "reasons": [reason["code"] for reason in result["reasons"]]}
            if "T_base_sensor" in result:
                line["position_mm"], line["angle_rad"] = error_of(result["T_base_sensor"], truth)
            lines.append(line)

        for index in range(2):
            capture, guess = one_posture(both, index, folder / str(index)), folder / f"guess_{index}.json"
            guess.write_text(json.dumps({"T_base_sensor": guess_near(truth, 2 * seed + index)}))
            calibrate("paper", str(index + 1), capture, "--method", "paper", "--guess", guess)
            calibrate("paper, three sensors", str(index + 1), capture, "--method", "paper", "--sampling", "three-sensors",
                      "--guess", guess)
            calibrate("full", str(index + 1), capture, "--guess", guess)
        calibrate("full", "both", both)
        return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=Path, required=True, help="folder of calibrd and calibrd-sim")
    parser.add_argument("--urdf", type=Path, required=True)
    parser.add_argument("--models", action="append", default=[])
    parser.add_argument("--level", default="cell")
    parser.add_argument("--first-seed", type=int, default=200001)
    parser.add_argument("--repetitions", type=int, default=25)
    options = parser.parse_args()
    options.models = [word for folder in options.models for word in ("--models", folder)]
    seeds = range(options.first_seed, options.first_seed + options.repetitions)
    with ThreadPoolExecutor(2) as pool:
        for lines in pool.map(lambda seed: repetition(options, seed), seeds):
            for line in lines:
                print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
