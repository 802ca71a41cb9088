#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# What the daemon survives.
#   scripts/faults.sh all               all of the following as they are without numbers, one after the other, an hour or more; a
#                                       failing one does not stop the next one, and is named in the last line
#   scripts/faults.sh kills [N] [SEED]  kills the daemon N times (200) at random moments of its calibrations in the simulated
#                                       cell, restarts it and checks what is stored
#   scripts/faults.sh storage           power cuts, failing system calls and allocations, each in turn; full, read-only and
#                                       damaged disks
#   scripts/faults.sh links             every call and allocation of the links to controller, motion port and sensor failing, each in turn
#   scripts/faults.sh disconnects [N [SEED [controller | sensor]]]
#                                       cuts it off from controller and sensor, N times each (1000, half an hour), and measures how
#                                       soon it has them again and what stays behind
#   scripts/faults.sh clock             the wall clock leaps by ten years and back; the daemon is stopped for ten seconds
# They are built first. docs/storage.md says what is promised of the store, docs/figures.md what was measured.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly kSuites=(storage links clock kills disconnects)

die() {
  echo "faults: $*; one of: all ${kSuites[*]}. See the head of scripts/faults.sh" >&2
  exit 2
}

run_all() {
  local suite failed=()
  for suite in "${kSuites[@]}"; do
    echo "== $suite"
    scripts/faults.sh "$suite" || failed+=("$suite")
  done
  [ ${#failed[@]} = 0 ] || { echo "failed: ${failed[*]}"; exit 1; }
  echo "passed: ${kSuites[*]}"
}

what=${1:-}
[ -n "$what" ] || die "say which"
shift
build() {
  [ -f build/release/CMakeCache.txt ] || cmake --preset release > /dev/null
  cmake --build build/release --target "$@" > /dev/null
}
case $what in
  all)
    [ $# = 0 ] || die "all takes no numbers"
    run_all
    ;;
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
    build test_robot_link_faults test_motion_link_faults test_sensor_faults
    ctest --test-dir build/release --output-on-failure --no-tests=error -R '(RobotLink|MotionLink|Sensor)Calls'
    ;;
  storage)
    build all
    ctest --test-dir build/release --output-on-failure --no-tests=error -R '^(PowerLoss|.*SystemCalls|Memory|Recovery|.*Hindered|e2e_storage)'
    ;;
  *) die "unknown '$what'" ;;
esac
