#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Fails when a shipped binary needs a library that a headless daemon must not need.

usage: linked_libraries.py BUILD_DIRECTORY
"""

import re
import subprocess
import sys
from pathlib import Path

# libpcl_io, _surface and _visualization bring VTK and Qt; _features and _segmentation bring 55 MB.
UNWANTED = re.compile(r"libQt\d|libvtk|libpcl_(io|surface|visualization|features|segmentation)\b")
NOT_SHIPPED = {"tests", "CMakeFiles", "_deps"}


def is_linked(path: Path) -> bool:
    with path.open("rb") as file:
        start = file.read(18)
    return start[:4] == b"\x7fELF" and start[16:18] != b"\x01\x00"  # not an object file


def shipped_binaries(build: Path) -> list[Path]:
    """Programs and shared libraries of a build, tests and examples left out."""
    return [path for path in sorted(build.rglob("*"))
            if path.is_file() and not path.is_symlink() and not NOT_SHIPPED.intersection(path.relative_to(build).parts)
            and path.stat().st_size > 18 and is_linked(path)]


def complaints(name: str, ldd: str) -> list[str]:
    """What is wrong with the lines ldd prints for one binary."""
    found = []
    for line in map(str.strip, ldd.splitlines()):
        if UNWANTED.match(line):
            found.append(f"{name}: needs {line.split()[0]}")
        if "not found" in line:
            found.append(f"{name}: {line}")
    return found


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    build = Path(sys.argv[1])
    binaries = shipped_binaries(build)
    found = []
    for binary in binaries:
        ldd = subprocess.run(["ldd", binary], capture_output=True, text=True, check=False)
        libraries = ldd.stdout + ldd.stderr
        found += complaints(str(binary.relative_to(build)), libraries)
        print(f"{binary.relative_to(build)}: {libraries.count('=>')} shared libraries")
    if not binaries:
        found.append(f"{build}: no binary found; build everything first")
    print("\n".join(found) if found else "no Qt, no VTK, nothing missing")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
