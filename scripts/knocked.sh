#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Calibrates in random simulated cells while the sensor is knocked between two postures, and undisturbed, and prints a
# table: how many are found out, and how wrong the accepted ones are.
#   scripts/knocked.sh [SCENES]    (default: 60)
#   --first-seed S  of the scenes (default: 500001; 1..999 are for tuning)
#   --keep FILE     where to leave the JSON lines
# What follows `--` goes to calibrd-bench:  scripts/knocked.sh -- --shift-mm 3 --turn-mrad 3 --postures 10
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# shellcheck source=scripts/lib/bench_robots.sh
. scripts/lib/bench_robots.sh
scenes=60 first=500001 kept=''

while [ $# -gt 0 ]; do
  case $1 in
    --first-seed) first=${2:?--first-seed needs a number} && shift ;;
    --keep) kept=${2:?--keep needs a file} && shift ;;
    --) shift && break ;;
    [0-9]*) scenes=$1 ;;
    *) die "unknown option '$1'; see the head of scripts/knocked.sh" ;;
  esac
  shift
done

find_robots
lines=${kept:-$(mktemp)}
"$bench" knocked "${robots[@]}" --first-seed "$first" --scenes "$scenes" "$@" > "$lines"
python3 scripts/knocked_table.py "$lines"
[ -n "$kept" ] || rm -f "$lines"
