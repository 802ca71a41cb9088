#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Many cells, one broker, one PostgreSQL; first undisturbed, then with both killed under load and away for a while.

usage: outage.py [--cells 200] [--rate 100] [--steady 60] [--outage 300]

Prints throughput, delay from the end of a calibration to its acknowledgement, memory of all exporters in one process, and how
many rows are missing or double. Exit status 0: none.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from fleet_test import BIN, EXPORTERS, free_port, stored_by_cells
from engines import Collector, Mosquitto, Postgres


def exporters(folder: Path, broker: Mosquitto, options, seconds: float, cells: int | None = None) -> subprocess.Popen:
    words = [EXPORTERS, folder, options.cells if cells is None else cells, broker.port, options.rate, seconds, 600]
    return subprocess.Popen([*map(str, words)], stdout=subprocess.PIPE, text=True)


def report_of(process: subprocess.Popen) -> dict:
    return json.loads(process.communicate(timeout=3600)[0])


def compare(folder: Path, postgres: Postgres) -> int:
    truth = stored_by_cells(folder)
    rows = [tuple(row) for row in postgres.ask("SELECT cell, calibration_id FROM calibrations")]
    missing, doubled = len(truth - set(rows)), len(rows) - len(set(rows))
    print(f"rows: {len(rows)} of {len(truth)} calibrations; lost {missing}, twice {doubled}, of nobody {len(set(rows) - truth)}")
    return missing + doubled


def run(folder: Path, options) -> int:
    broker, postgres = Mosquitto(folder, free_port()), Postgres(folder)
    collector = Collector(folder, BIN / "calibrd-collector", broker, postgres)
    try:
        print("no load:   ", json.dumps(report_of(exporters(folder, broker, options, 0))), flush=True)
        print("steady:    ", json.dumps(report_of(exporters(folder, broker, options, options.steady))), flush=True)
        work = exporters(folder, broker, options, options.outage + 30)
        time.sleep(10)
        broker.kill()
        postgres.kill()
        time.sleep(options.outage)
        broker.start()
        postgres.start()
        print("outage:    ", json.dumps(report_of(work)), flush=True)
        return compare(folder, postgres)
    finally:
        for engine in (collector, postgres, broker):
            if engine.process.poll() is None:
                engine.kill()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name, default in (("cells", 200), ("rate", 100), ("steady", 60), ("outage", 300)):
        parser.add_argument(f"--{name}", type=int, default=default)
    options = parser.parse_args()
    print(f"{options.cells} cells, {options.rate} calibrations/s in all, broker and database away for {options.outage} s")
    with tempfile.TemporaryDirectory(prefix="calibrd-fleet-") as folder:
        return 1 if run(Path(folder), options) else 0


if __name__ == "__main__":
    sys.exit(main())
