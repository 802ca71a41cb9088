#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Repeats the paper's experiment in the simulated cell by its method and by ours, and draws its figures 8 and 9 for both:
# docs/results/*.svg, and the tables of docs/results.md.
#   scripts/results.sh                  25 repetitions of two postures, seeds from 200001
#   scripts/results.sh --repetitions N --first-seed S    others
#   scripts/results.sh --keep DIR       also leaves the lines of all calibrations there
#   scripts/results.sh --docs DIR       writes there (a copy of docs/) and not into docs/
# With CALIBRD_SHARED_DATA set, the SIA5D in its models/ takes part beside the arm of the project.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=build/${CALIBRD_PRESET:-release}
docs=docs kept='' options=()

die() {
  echo "results.sh: $*" >&2
  exit 2
}

while [ $# -gt 0 ]; do
  case $1 in
    --repetitions | --first-seed) options+=("$1" "${2:?$1 needs a number}") ;;
    --keep) kept=${2:?--keep needs a folder} ;;
    --docs) docs=${2:?--docs needs a folder} ;;
    *) die "unknown option '$1'; see the head of scripts/results.sh" ;;
  esac
  shift 2
done

arm7=$build/share/calibrd/robots/demo_arm7/urdf/demo_arm7.urdf
for needed in "$build/bin/calibrd" "$build/bin/calibrd-sim" "$arm7"; do
  [ -e "$needed" ] || die "$needed is missing; run scripts/test.sh first"
done
lines=$(mktemp)
trap 'rm -f "$lines"' EXIT

# experiment NAME LEVEL TITLE URDF [--models DIR]
experiment() {
  local name=$1 level=$2 title=$3
  shift 3
  echo "== $title"
  python3 -B scripts/results_run.py --bin "$build/bin" --level "$level" "${options[@]}" --urdf "$@" > "$lines"
  if [ -n "$kept" ]; then mkdir -p "$kept" && cp "$lines" "$kept/$name.jsonl"; fi
  python3 -B scripts/results_figures.py "$lines" "$name" "$title" "$docs"
}

experiment arm7_clean clean "7-axis arm alone" "$arm7"
experiment arm7_cell cell "7-axis arm in a cell" "$arm7"
models=${CALIBRD_SHARED_DATA:+$CALIBRD_SHARED_DATA/models}
sia5d=$models/motoman_sia5d_support/urdf/sia5d.urdf
if [ -n "$models" ] && [ -f "$sia5d" ]; then
  experiment sia5d_clean clean "SIA5D alone" "$sia5d" --models "$models"
  experiment sia5d_cell cell "SIA5D in a cell" "$sia5d" --models "$models"
fi
