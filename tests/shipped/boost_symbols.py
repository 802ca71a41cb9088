#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Fails when two Boosts meet in one program.

On Debian 12 the system's Boost is 1.74, and calibrd is compiled against 1.81 in a prefix of its own. The linker
keeps one of two weak symbols of the same name, without a word, whichever Boost it came from. So
- no object may see both Boosts,
- no weak symbol that speaks of boost may be defined by objects of both sides, unless they are linked apart: into a
  module, which is loaded at run time (libcalibrd_pcl.so),
- a module may export no such symbol,
- no program may export such a symbol that a shared object it loads defines as well (as PCL's do), be it through a
  module: it would take the other's place.

usage: boost_symbols.py BUILD_DIRECTORY NINJA
"""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Iterable, NamedTuple

SYSTEM, PRIVATE = "system", "private"
WEAK_KINDS = frozenset("VWvwu")


class BoostUse(NamedTuple):
    """Objects by the Boost they were compiled against."""

    system: list[str]
    private: list[str]
    both: list[str]


def side_of(header: str, build: Path) -> str | None:
    if "/boost/" not in header:
        return None
    path = os.path.normpath(build / header)  # ccache may make any path relative to the build directory
    return SYSTEM if path.startswith("/usr/include/boost/") else PRIVATE


def headers_of(ninja_deps: str, build: Path) -> dict[str, set[str]]:
    """Reads `ninja -t deps`: an object per paragraph, then an indented line per header. Of a precompiled header an
    object lists the name alone; what that has seen, the object has seen as well."""
    found = {}
    for paragraph in ninja_deps.split("\n\n"):
        first, *headers = paragraph.strip().splitlines() or [""]
        found[first.split(":")[0]] = {header.strip() for header in headers}
    precompiled = {os.path.normpath(build / name): headers for name, headers in found.items() if name.endswith(".gch")}
    return {name: headers.union(*(precompiled.get(os.path.normpath(build / header), ()) for header in headers
                                  if header.endswith(".gch")))
            for name, headers in found.items() if not name.endswith(".gch")}


def sort_objects(ninja_deps: str, build: Path) -> BoostUse:
    use = BoostUse([], [], [])
    for name, headers in headers_of(ninja_deps, build).items():
        sides = {side_of(header, build) for header in headers} - {None}
        if sides == {SYSTEM, PRIVATE}:
            use.both.append(name)
        elif sides:
            (use.system if sides == {SYSTEM} else use.private).append(name)
    return use


def weak_boost_symbols(nm: str) -> set[str]:
    """The weak symbols in `nm` output in whose mangled name boost:: occurs."""
    found = set()
    for line in nm.splitlines():
        parts = line.split()
        if len(parts) == 3 and parts[1] in WEAK_KINDS and "5boost" in parts[2]:
            found.add(parts[2])
    return found


def run(*command: str, cwd: Path | None = None) -> str:
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False).stdout


def symbols_of(objects: Iterable[str], build: Path) -> set[str]:
    return set().union(*(weak_boost_symbols(run("nm", "--defined-only", name, cwd=build)) for name in objects
                         if (build / name).is_file()))


def exported_symbols(binary: str) -> set[str]:
    return weak_boost_symbols(run("nm", "-D", "--defined-only", binary))


def displaced_by(program: Path, modules: Iterable[Path] = ()) -> set[str]:
    """The symbols of shared objects in whose place the program would put its own, those of its modules included."""
    exported = exported_symbols(str(program))
    libraries = {library for user in (program, *modules) for library in re.findall(r"=> (/\S+)", run("ldd", str(user)))
                 } if exported else set()
    return exported.intersection(set().union(*map(exported_symbols, libraries)))


def linked_into(module: Path, build: Path, ninja: str) -> set[str]:
    """The objects that a module is linked from."""
    query = run(ninja, "-t", "query", str(module.relative_to(build)), cwd=build)
    return set(re.findall(r"^\s+(\S+\.o)$", query, re.MULTILINE))


def readable(symbols: set[str]) -> list[str]:
    return run("c++filt", *sorted(symbols)).splitlines() if symbols else []


def check(build: Path, ninja: str) -> tuple[list[str], str]:
    """What is wrong, and what was looked at."""
    use = sort_objects(run(ninja, "-t", "deps", cwd=build), build)
    if not use.private:
        return [], f"one Boost only: {len(use.system)} objects use the system's, none a private one"
    programs = [path for path in sorted((build / "bin").glob("*")) if path.is_file()]
    modules = sorted((build / "lib/calibrd").glob("*.so"))
    apart = set().union(*(linked_into(module, build, ninja) for module in modules))
    system, private = (symbols_of(set(objects) - apart, build) for objects in (use.system, use.private))
    found = [f"{name}: sees both Boosts" for name in use.both]
    found += [f"weak on both sides: {name}" for name in readable(system & private)]
    found += [f"{path.name} exports over a shared object: {name}"
              for path in programs for name in readable(displaced_by(path, modules))]
    found += [f"{path.name} exports: {name}" for path in modules for name in readable(exported_symbols(str(path)))]
    return found, (f"{len(use.system)} objects use the system's Boost ({len(system)} weak symbols), {len(use.private)} "
                   f"the private one ({len(private)}); {len(programs)} programs, {len(modules)} modules of {len(apart)} objects")


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    found, looked_at = check(Path(sys.argv[1]).resolve(), sys.argv[2])
    print("\n".join([looked_at, *found[:50]]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
