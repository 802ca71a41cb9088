#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Makes the corpora of the fuzz targets, a folder for each: the texts in corpus/, the bytes of seed_bytes.py, the
example configurations, and what fuzzing has found (findings/TARGET/*.hex).

usage: make_corpus.py REPOSITORY FOLDER
"""

import shutil
import sys
from pathlib import Path

import seed_bytes

HERE = Path(__file__).parent


def hex_files(target: str) -> dict[str, bytes]:
    """Lines that begin with # say what the input was found to do."""
    found = {}
    for path in sorted((HERE / "findings" / target).glob("*.hex")):
        lines = path.read_text(encoding="utf-8").splitlines()
        found["finding_" + path.stem] = bytes.fromhex("".join(line for line in lines if not line.startswith("#")))
    return found


def text_files(target: str) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((HERE / "corpus" / target).glob("*"))}


def configurations(repository: Path) -> dict[str, bytes]:
    folder = repository / "config"
    return {path.name: path.read_bytes() for path in [folder / "calibrd.toml", *sorted(folder.glob("examples/*.toml"))]}


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    repository, out = Path(sys.argv[1]), Path(sys.argv[2])
    seeds = seed_bytes.all_seeds((HERE / "corpus" / "capture" / "two_frames.json").read_bytes())
    seeds["config"] = configurations(repository)
    targets = {path.name for part in ("corpus", "findings") for path in (HERE / part).glob("*")} | set(seeds)
    shutil.rmtree(out, ignore_errors=True)
    for target in sorted(targets):
        (out / target).mkdir(parents=True)
        for name, content in {**text_files(target), **seeds.get(target, {}), **hex_files(target)}.items():
            (out / target / name).write_bytes(content)
    return 0


if __name__ == "__main__":
    sys.exit(main())
