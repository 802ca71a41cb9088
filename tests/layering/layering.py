#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Fails when an include breaks the layering: server -> fleet -> api -> core, server -> {api, drivers} -> core.

usage: layering.py REPOSITORY
"""

import re
import sys
from pathlib import Path
from typing import Iterator, NamedTuple

# Layer -> what its files may include of the project. The longest matching layer counts.
MAY_INCLUDE = {
    "core": ("core",),
    "drivers": ("drivers", "core"),
    # The simulator is the judge of core: if it shared core's geometry, it would share core's errors.
    "drivers/sim": ("drivers/sim", "core/base"),
    "api": ("api", "core"),
    # What leaves the cell: the exporter tells what the API tells; the collector knows topics and PostgreSQL, no cell.
    "fleet": ("fleet/exporter", "fleet/mqtt", "fleet/messages", "api", "core"),
    "fleet/messages": ("fleet/messages", "core"),
    "fleet/mqtt": ("fleet/mqtt", "core"),
    "fleet/collector": ("fleet/collector", "fleet/mqtt", "fleet/messages", "core"),
    "server": ("server", "fleet/exporter", "fleet/messages", "api", "drivers", "core"),
    "config": ("config", "core"),
    "tests": ("tests", "server", "fleet", "api", "drivers", "core", "config"),
}
FOLDERS = ("core", "drivers", "api", "fleet", "server", "config", "tests")


class Rule(NamedTuple):
    """Files whose path matches `files` include nothing that matches `headers`, directly or through others."""

    files: str
    headers: str
    why: str


RULES = (
    Rule(r"core/", r"boost/(asio|beast)\b|sys/socket\.h|netinet/|arpa/", "core opens no socket"),
    Rule(r"core/", r"OpenNI|Driver/Oni", "core knows no camera"),
    # What is linked into a program may not see PCL: it brings the system's Boost with it.
    Rule(r"(?!core/paper/pcl/)", r"pcl/", "PCL is fenced into core/paper/pcl, a shared object of its own"),
    Rule(r"(core|api|server)/", r"OpenNI|Driver/Oni", "OpenNI is fenced into drivers"),
    Rule(r"drivers/sim/", r"core/(?!base/)", "the simulator shares nothing but error values with core"),
    Rule(r"api/", r"drivers/", "api knows no driver"),
    Rule(r"(?!fleet/mqtt/)", r"mosquitto|mqtt_protocol", "libmosquitto is fenced into fleet/mqtt"),
    Rule(r"(?!fleet/collector/)", r"libpq", "daemons hold no way into a database server: libpq is fenced into fleet/collector"),
)

FOREIGN = re.compile(r"pcl/|boost/|embree|assimp/|urdf|nanoflann|tbb/|spng|sqlite3")
PCL = re.compile(r"pcl/")
NEW_BOOST = re.compile(r"boost/(asio|beast|json)\b")
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:<([^>]+)>|"([^"]+)")')


class Include(NamedTuple):
    line: int
    header: str


def read_includes(path: Path) -> list[Include]:
    found = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        match = INCLUDE.match(line)
        if match:
            found.append(Include(number, match[1] or match[2]))
    return found


class Tree:
    """The C++ files of a repository and what each of them includes."""

    def __init__(self, root: Path):
        self.includes: dict[str, list[Include]] = {}
        for folder in FOLDERS:
            for path in sorted((root / folder).rglob("*")):
                if path.suffix in (".hpp", ".cpp", ".h"):
                    self.includes[path.relative_to(root).as_posix()] = read_includes(path)

    def resolve(self, file: str, header: str) -> str:
        """The repository path of a header, or the header as it is written when it is nobody's here."""
        sibling = (Path(file).parent / header).as_posix()
        return sibling if header not in self.includes and sibling in self.includes else header

    def reached(self, file: str) -> dict[str, tuple[str, ...]]:
        """Every header that `file` sees, with the chain of files through which it sees it."""
        seen: dict[str, tuple[str, ...]] = {}
        todo = [(file, (file,))]
        while todo:
            current, chain = todo.pop()
            for include in self.includes.get(current, []):
                header = self.resolve(current, include.header)
                if header not in seen:
                    seen[header] = chain
                    todo.append((header, chain + (header,)))
        return seen


def layer_of(path: str) -> str:
    return max((layer for layer in MAY_INCLUDE if path.startswith(layer + "/")), key=len, default="")


def wrong_directions(tree: Tree) -> Iterator[str]:
    for file, includes in tree.includes.items():
        allowed = MAY_INCLUDE[layer_of(file)]
        for include in includes:
            header = tree.resolve(file, include.header)
            if layer_of(header) and not any(header.startswith(a + "/") for a in allowed):
                yield f"{file}:{include.line}: includes {header}; {layer_of(file)} may include {', '.join(allowed)}"


def broken_rules(tree: Tree) -> Iterator[str]:
    for file in tree.includes:
        for header, chain in tree.reached(file).items():
            for rule in RULES:
                if re.match(rule.files, file) and re.match(rule.headers, header):
                    yield f"{' -> '.join(chain)}: sees {header}; {rule.why}"


def foreign_types_in_public(tree: Tree) -> Iterator[str]:
    """A header of core is public when a file of another folder sees it."""
    found = set()
    for file in tree.includes:
        for header, chain in tree.reached(file).items():
            shown_by, elsewhere = chain[-1], Path(chain[-1]).parent != Path(file).parent
            if layer_of(file) != "tests" and layer_of(shown_by) == "core" and elsewhere and FOREIGN.match(header):
                found.add(f"{shown_by}: shows {header} to {file}; public headers of core show Eigen and own types alone")
    yield from sorted(found)


def two_boosts(tree: Tree) -> Iterator[str]:
    """PCL means the system's Boost, Asio, Beast and JSON mean another one on Debian 12."""
    for file in tree.includes:
        seen = tree.reached(file)
        pcl = next(filter(PCL.match, seen), None)
        boost = next(filter(NEW_BOOST.match, seen), None)
        if pcl and boost:
            yield f"{file}: sees {pcl} and {boost}; no translation unit may see PCL and Asio, Beast or JSON"


def violations(root: Path) -> list[str]:
    tree = Tree(root)
    if not tree.includes:
        return [f"{root}: no source file found"]
    return [*wrong_directions(tree), *broken_rules(tree), *foreign_types_in_public(tree), *two_boosts(tree)]


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    found = violations(Path(sys.argv[1]))
    print("\n".join(found) if found else "layering holds")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
