#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# 200 cells' exporters, a mosquitto and a PostgreSQL of its own on this machine: throughput, delay and memory, then five
# minutes without broker and database under load, and the rows counted. Exit status 0: none lost, none twice.
#   scripts/fleet.sh [--cells 200] [--rate 100] [--steady 60] [--outage 300]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh --fleet
cmake --preset release >/dev/null
cmake --build --preset release --target calibrd-collector fleet_exporters
exec python3 -B tests/fleet/outage.py "$@"
