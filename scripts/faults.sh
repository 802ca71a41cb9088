#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# What the daemon survives.
#   scripts/faults.sh kills [N] [SEED]  kills the daemon N times (200) at random moments of its calibrations in the simulated
#                                       cell, restarts it and checks what is stored
#   scripts/faults.sh storage           power cuts, failing system calls and allocations, each in turn; full, read-only and
#                                       damaged disks
#   scripts/faults.sh links             every call and allocation of the links to controller and sensor failing, each in turn
#   scripts/faults.sh disconnects [N [SEED [controller | sensor]]]
#                                       cuts it off from controller and sensor, N times each (1000, half an hour), and measures how
#                                       soon it has them again and what stays behind
#   scripts/faults.sh clock             the wall clock leaps by ten years and back; the daemon is stopped for ten seconds
# They are built first. docs/storage.md says what is promised of the store, docs/figures.md what was measured.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

what=${1:-}
[ $# -gt 0 ] && shift
build() { cmake --build build/release --target "$@" > /dev/null; }
[ -f build/release/CMakeCache.txt ] || cmake --preset release > /dev/null
case $what in
  kills)
    build all
    python3 -B tests/e2e/kills.py "$@"
    ;;
  disconnects)
    build all
    python3 -B tests/e2e/disconnects.py "$@"
    ;;
  clock)
    build all
    python3 -B tests/e2e/clock_test.py "$@"
    ;;
  links)
    build test_robot_link_faults test_sensor_faults
    ctest --test-dir build/release --output-on-failure -R '(RobotLink|Sensor)Calls'
    ;;
  storage)
    build all
    ctest --test-dir build/release --output-on-failure -R '^(PowerLoss|.*SystemCalls|Memory|Recovery|.*Hindered|e2e_storage)'
    ;;
  *)
    echo "faults: unknown '$what'; see the head of scripts/faults.sh" >&2
    exit 2
    ;;
esac
