#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Watches sensors of random simulated cells for drift and prints the tables.
#   scripts/watch.sh               what is staged against what is said: one event of each kind in 45 scenes
#   scripts/watch.sh --creep       sensors that creep by 1 mm or 1 mrad per hour while they warm up: 16 of them
#   scripts/watch.sh --hours H     false alarms: H hours of 6 cells at work, then 72 hours drawn from their innovations
#   --short         3 scenes, 2 sensors that creep, or 0.05 hours of 2 cells
#   --tuning        seeds from 1 instead of from 300001: 1..999 are for tuning, the others for reports, never both
#   --first-seed S  other seeds for the report, from 100001 on
#   --scenes N      another number of scenes, sensors or cells
#   --keep FILE     where to leave the JSON lines
#   --require       exit status 1 unless all is as it must be: see scripts/watch_table.py
# What follows `--` goes to calibrd-bench:  scripts/watch.sh -- --event sensor_moved
# With CALIBRD_SHARED_DATA set, the SIA5D in its models/ takes part beside the robots of the project.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# shellcheck source=scripts/lib/bench_robots.sh
. scripts/lib/bench_robots.sh
first=300001 scenes=45 what=events hours=1 kept='' short='' require=()

while [ $# -gt 0 ]; do
  case $1 in
    --creep) what=creep scenes=16 ;;
    --hours) what=hours scenes=6 hours=${2:?--hours needs a number} && shift ;;
    --short) short=1 ;;
    --tuning) first=1 ;;
    --first-seed) first=${2:?--first-seed needs a number} && shift ;;
    --scenes) given=${2:?--scenes needs a number} && shift ;;
    --keep) kept=${2:?--keep needs a file} && shift ;;
    --require) require=(--require) ;;
    --) shift && break ;;
    *) die "unknown option '$1'; see the head of scripts/watch.sh" ;;
  esac
  shift
done
if [ -n "$short" ]; then
  scenes=2 hours=0.05
  [ "$what" = events ] && scenes=3
fi
scenes=${given:-$scenes}

find_robots
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
lines=$scratch/lines.jsonl
case $what in
  events) "$bench" watch "${robots[@]}" --first-seed "$first" --scenes "$scenes" "$@" > "$lines" ;;
  creep) "$bench" watch-creep "${robots[@]}" --first-seed "$first" --cells "$scenes" "$@" > "$lines" ;;
  hours)
    "$bench" watch-hours "${robots[@]}" --first-seed "$first" --cells "$scenes" --hours "$hours" \
      --innovations "$scratch/innovations" "$@" > "$lines"
    "$bench" watch-tail "$scratch/innovations" >> "$lines"
    ;;
esac
if [ -n "$kept" ]; then cp "$lines" "$kept"; fi
python3 scripts/watch_table.py "${require[@]}" "$lines"
