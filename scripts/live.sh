#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Figures of the live cell (docs/figures.md): the daemon and the simulated cell over their real links. JSON lines and a table.
#   scripts/live.sh healing [KNOCKS [SEED]] [--slow]      a sensor that is knocked: until its pose is true again; 4 minutes
#   scripts/live.sh load [SECONDS [SENSORS...]]           what watching 1, 2, 4 and 8 sensors at 30 Hz costs; 6 minutes
#   scripts/live.sh events [--rounds N] [--seed S] [--event VERDICT] [--knocks-first]
#                                                         what is staged against what is said; 5 minutes a round
#   scripts/live.sh slides [MOVES [SEED]]                small pure slides and turns: for how long a wrong pose is served
#   scripts/live.sh hour [HOURS [SEED]]                   false alarms: nobody moves the sensor, everything else happens
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=$PWD/build/${CALIBRD_PRESET:-release}
[ -x "$build/bin/calibrd" ] || { echo "live.sh: $build/bin/calibrd is missing; run scripts/test.sh first" >&2 && exit 2; }
what=${1:-}
case $what in
  healing | load | events | slides | hour) shift && CALIBRD_BUILD=$build exec python3 -B "tests/live/$what.py" "$@" ;;
  *) echo "live.sh: unknown figure '$what'; see the head of scripts/live.sh" >&2 && exit 2 ;;
esac
