#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs what is missing, builds the release preset, runs every test. Works on a machine with nothing installed.
# Arguments go to ctest:   scripts/test.sh -R link_machine
# CALIBRD_PRESET=debug     takes another preset.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${CALIBRD_PRESET:-release}
log=build/$preset/ctest.log
shares=$((3 * $(nproc))) # CALIBRD_ONE_PROCESSOR: tests that wait for most of their time take less than a whole one

scripts/setup.sh --fleet
cmake --preset "$preset"
cmake --build --preset "$preset"

status=0
ctest --preset "$preset" --parallel "$shares" --output-log "$log" "$@" || status=$?

# ctest ends with the names of failed or skipped tests; whoever reads only the last line wants the sum.
grep -E '^[0-9]+% tests passed' "$log" | tail -n 1 || echo "no test ran (see $log)"
exit "$status"
