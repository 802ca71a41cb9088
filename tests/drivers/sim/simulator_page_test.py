#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Runs every curl line of docs/simulator.md against a running simulator: each must answer 200.

usage: simulator_page_test.py CALIBRD_SIM URDF REPOSITORY
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PORT_IN_PAGE = "127.0.0.1:8078"


def start(program: str, urdf: str, root: Path, folder: Path) -> tuple[subprocess.Popen, str]:
    """The simulator, and the address of its control calls."""
    ready = folder / "ready"
    process = subprocess.Popen(
        [program, "run", "--world", root / "config/demo_cell/world.json", "--urdf", urdf, "--world-file",
         folder / "world", "--controller-port", "0", "--control-port", "0", "--ready-file", ready],
        stdout=subprocess.DEVNULL)
    deadline = time.monotonic() + 60
    while not ready.exists():
        if process.poll() is not None or time.monotonic() > deadline:
            raise SystemExit("the simulator did not start")
        time.sleep(0.02)
    return process, dict(word.split("=") for word in ready.read_text().split()[1:])["control"]


def curl_lines(page: Path) -> list[str]:
    return [line.strip() for line in page.read_text().splitlines() if line.startswith("    curl ")]


def fails(line: str, control: str) -> str:
    """What is wrong with the answer to a line; empty when nothing is."""
    run = subprocess.run(line.replace(PORT_IN_PAGE, control) + " -s -w '\\n%{http_code}'", shell=True,
                         capture_output=True, text=True, timeout=60)
    body, _, status = run.stdout.rpartition("\n")
    try:
        json.loads(body)
    except ValueError:
        return f"no JSON: {run.stdout}{run.stderr}"
    return "" if status == "200" else f"{status}: {body}"


def main() -> int:
    program, urdf, root = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    lines = curl_lines(root / "docs/simulator.md")
    if len(lines) < 20:
        print(f"only {len(lines)} curl lines on the page")
        return 1
    with tempfile.TemporaryDirectory() as folder:
        process, control = start(program, urdf, root, Path(folder))
        try:
            wrong = [f"{line}\n  {what}" for line in lines if (what := fails(line, control))]
        finally:
            process.terminate()
            process.wait(timeout=10)
    print("\n".join(wrong) if wrong else f"{len(lines)} calls answer as the page says")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
