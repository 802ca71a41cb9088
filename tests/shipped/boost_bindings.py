#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the paper's method and fails when a symbol of Boost is bound across the border of PCL.

libcalibrd_pcl.so and PCL's libraries use the system's Boost, calibrd another one on Debian 12. Whom the dynamic linker
binds to whom is seen only when they run together: it writes that down itself.

usage: boost_bindings.py BUILD_DIRECTORY
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

BINDING = re.compile(r"binding file (\S+) \[\d+\] to (\S+) \[\d+\]: \w+ symbol `(\S+)'")
PCL = re.compile(r"lib(calibrd_)?pcl")


def is_pcl(path: str) -> bool:
    return PCL.match(Path(path).name) is not None


def crossings(log: str) -> list[str]:
    """The bindings of Boost's symbols with one end at PCL and the other elsewhere."""
    return [f"{user} takes {symbol} from {definer}" for user, definer, symbol in BINDING.findall(log)
            if "5boost" in symbol and is_pcl(user) != is_pcl(definer)]


def record(build: Path, folder: Path) -> tuple[Path, Path]:
    """A simulated posture, and its true pose as a file."""
    capture, guess = folder / "capture", folder / "guess.json"
    urdf = build / "share/calibrd/robots/demo_arm7/urdf/demo_arm7.urdf"
    subprocess.run([build / "bin/calibrd-sim", "capture", capture, "--urdf", urdf, "--postures", "1", "--level", "clean"],
                   check=True, stdout=subprocess.DEVNULL)
    truth = json.loads((capture / "truth.json").read_text())
    guess.write_text(json.dumps({"T_base_sensor": truth["T_base_sensor"]}))
    return capture, guess


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    build = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        capture, guess = record(build, folder)
        ended = subprocess.run([build / "bin/calibrd", "calibrate", capture, "--method", "paper", "--guess", guess],
                               env={**os.environ, "LD_DEBUG": "bindings", "LD_DEBUG_OUTPUT": str(folder / "bindings")},
                               capture_output=True, text=True, check=False)
        log = "".join(path.read_text(errors="replace") for path in folder.glob("bindings.*"))
    result = json.loads(ended.stdout or "{}")
    found = crossings(log)
    if "T_base_sensor" not in result:
        found.append(f"the paper's method gave no pose: {result.get('reasons')} {ended.stderr}")
    pcl = sum(is_pcl(user) for user, _, _ in BINDING.findall(log))
    if pcl == 0:
        found.append("PCL was not loaded")
    print("\n".join([f"{pcl} symbols bound for PCL", *found[:50]]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
