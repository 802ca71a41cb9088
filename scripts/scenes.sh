#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Calibrates random simulated scenes, holds the truth against the results and prints the table.
#   scripts/scenes.sh             240 scenes, levels and robots in turn, from 10, 6 and 4 postures
#   scripts/scenes.sh --short     12 of them
#   scripts/scenes.sh --bound     60 scenes of noise alone, depth alone: errors over the Cramer-Rao bound
#   --tuning        seeds from 1 instead of from 100001: 1..999 are for tuning, the others for reports, never both
#   --first-seed S  other seeds for the report, from 100001 on
#   --scenes N      another number of scenes
#   --postures K,K  other numbers of postures
#   --keep FILE     where to leave the JSON lines
# What follows `--` goes to calibrd-bench scenes:  scripts/scenes.sh --short -- --guess-mm 40 --guess-deg 4
# With CALIBRD_SHARED_DATA set, the SIA5D in its models/ takes part beside the robots of the project.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# shellcheck source=scripts/lib/bench_robots.sh
. scripts/lib/bench_robots.sh
first=100001 scenes=240 postures=10,6,4 kept='' mode=()

while [ $# -gt 0 ]; do
  case $1 in
    --short) short=12 ;;
    --bound) mode=(--bound) scenes=60 postures=10,6,4 ;;
    --tuning) first=1 ;;
    --first-seed) first=${2:?--first-seed needs a number} && shift ;;
    --scenes) short=${2:?--scenes needs a number} && shift ;;
    --postures) only=${2:?--postures needs numbers} && shift ;;
    --keep) kept=${2:?--keep needs a file} && shift ;;
    --) shift && break ;;
    *) die "unknown option '$1'; see the head of scripts/scenes.sh" ;;
  esac
  shift
done
scenes=${short:-$scenes} postures=${only:-$postures}

find_robots
options=(--level mixed)
if [ ${#mode[@]} -gt 0 ]; then options=(--noise-only --depth-only --bound); fi
lines=$(mktemp)
trap 'rm -f "$lines"' EXIT
"$bench" scenes "${robots[@]}" "${options[@]}" --first-seed "$first" --scenes "$scenes" --postures "$postures" "$@" > "$lines"
if [ -n "$kept" ]; then cp "$lines" "$kept"; fi
python3 scripts/scenes_table.py "${mode[@]}" "$lines"
