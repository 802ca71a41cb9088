#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Registers every pair of clouds and prints a table: median and least time, and rms displacement over the source's
# points against the true transform. On a machine with other work the least time says more than the median.
#   scripts/pairs.sh [DATA_DIR]     (default: ../shared/data; pairs are DATA_DIR/pairs/*/{source,target}.ply, truth.txt)
set -euo pipefail
cd "$(dirname "$0")/.."
data=${1:-../shared/data}
bench=build/release/bin/calibrd-bench
[ -d "$data/pairs" ] || { echo "pairs.sh: no folder $data/pairs; name the folder that holds pairs" >&2; exit 2; }
[ -x "$bench" ] || { echo "pairs.sh: $bench is missing; run scripts/test.sh first" >&2; exit 2; }

printf '%-12s %10s %10s %10s %6s %8s\n' pair 'median ms' 'least ms' 'rms mm' steps overlap
for pair in "$data"/pairs/*/; do
  "$bench" register --source "$pair/source.ply" --target "$pair/target.ply" --runs "${RUNS:-50}" \
    | python3 scripts/pairs_row.py "$pair"
done
