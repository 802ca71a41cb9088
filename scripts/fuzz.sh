#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Fuzzes what reads bytes from elsewhere, with libFuzzer and the address and undefined-behaviour sanitizers.
#   scripts/fuzz.sh                      builds, then every target for 600 s, two at a time
#   scripts/fuzz.sh SECONDS [TARGET...]  for so long, these only: scripts/fuzz.sh 60 urdf mesh
# CALIBRD_FUZZ_JOBS=N                    so many targets at a time
# What was found lies in build/fuzz/findings/TARGET, the log beside it; then the exit status is 1. Inputs that reached
# something new stay in build/fuzz/corpus/TARGET for the next run. How to go on from a finding: docs/fuzzing.md.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly build=build/fuzz source=tests/fuzz
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_stack_use_after_return=1:strict_string_checks=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-halt_on_error=1:print_stacktrace=1}

seconds=${1:-600}
[[ $seconds =~ ^[0-9]+$ ]] || { echo "fuzz.sh: '$seconds' is no number of seconds" >&2; exit 2; }
shift $(($# > 0 ? 1 : 0))

all_targets() { sed -n 's/^calibrd_fuzz_target(\([a-z_]*\) .*/\1/p' $source/CMakeLists.txt; }

# One target: run NAME
run() {
  local name=$1 options=()
  mkdir -p "$build/corpus/$name" "$build/findings/$name"
  if [ -f "$source/dictionaries/$name.dict" ]; then options+=("-dict=$source/dictionaries/$name.dict"); fi
  TMPDIR=$scratch "$build/tests/fuzz_$name" -max_total_time="$seconds" -timeout=60 -report_slow_units=60 -rss_limit_mb=2560 \
    -max_len=16384 -print_final_stats=1 -artifact_prefix="$build/findings/$name/" "${options[@]}" \
    "$build/corpus/$name" "$build/tests/fuzz/corpora/$name" > "$build/findings/$name.log" 2>&1 || true
}

# Its line of the table: report NAME
report() {
  local log=$build/findings/$1.log found runs rate coverage
  found=$(find "$build/findings/$1" -type f | wc -l)
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
  coverage=$(grep -oE 'cov: [0-9]+' "$log" | tail -n 1 || true)
  printf '| %s | %s | %s | %s | %s |\n' "$1" "${runs:-did not run}" "${rate:--}" "${coverage#cov: }" "$found"
  [ "$found" = 0 ] && [ -n "$runs" ]
}

scripts/setup.sh --fuzz
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz

targets=("$@")
if [ $# = 0 ]; then mapfile -t targets < <(all_targets); fi
for name in "${targets[@]}"; do
  [ -x "$build/tests/fuzz_$name" ] || { echo "no target '$name'; there are: $(all_targets | xargs)" >&2; exit 2; }
  rm -rf "$build/findings/$name"
done
scratch=$(mktemp -d -p "$([ -w /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")" calibrd-fuzz-XXXXXX)
trap 'rm -rf "$scratch"' EXIT

for name in "${targets[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "${CALIBRD_FUZZ_JOBS:-2}" ]; do wait -n; done
  echo "fuzzing $name for $seconds s" >&2
  run "$name" &
done
wait

status=0
printf '| target | inputs | per second | edges reached | findings |\n|---|---|---|---|---|\n'
for name in "${targets[@]}"; do report "$name" || status=1; done
exit "$status"
