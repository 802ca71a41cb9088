#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# The evidence that takes longer than scripts/test.sh may:
#   release   tests marked CONFIGURATIONS Deep (long tables, long runs)
#   asan      every test under the address and undefined-behaviour sanitizers
#   tsan      every test under the thread sanitizer
#   faults    scripts/faults.sh all: kills, power cuts, failing calls, lost links, a leaping clock
#   image     docker/Dockerfile, built and run with buildah (as root, when it is installed)
#   format    clang-format, in check mode     (when it is installed)
#   tidy      clang-tidy over every source but those of tests    (when it is installed)
# usage: scripts/test_deep.sh [STEP...]   default: all of them; a failing step does not stop the next one
# The last line names what failed, what passed and what was left out.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 2

export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_stack_use_after_return=1:strict_string_checks=1}
export LSAN_OPTIONS=${LSAN_OPTIONS:-suppressions=$PWD/scripts/lsan.supp:print_suppressions=0}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-halt_on_error=1:print_stacktrace=1}
export TSAN_OPTIONS=${TSAN_OPTIONS:-halt_on_error=1:second_deadlock_stack=1:suppressions=$PWD/scripts/tsan.supp}

readonly kLeftOut=77 kTidied="$PWD/(core|drivers|api|fleet|server|config)/"

left_out() { echo "$1 here: step left out"; return $kLeftOut; }

build() { cmake --preset "$1" && cmake --build --preset "$1"; }

step_release() { build release && ctest --preset release -C Deep -L deep --no-tests=ignore; }

step_asan() { build asan && ctest --preset asan --parallel "$((3 * $(nproc)))"; }

# GCC's thread sanitizer cannot live with the address layout of newer kernels: switch its randomisation off.
step_tsan() {
  local fixed=()
  setarch -R true 2>/dev/null && fixed=(setarch -R)
  "${fixed[@]}" cmake --preset tsan && "${fixed[@]}" cmake --build --preset tsan &&
    "${fixed[@]}" ctest --preset tsan --parallel "$((3 * $(nproc)))"
}

step_faults() { scripts/faults.sh all; }

step_image() {
  command -v buildah >/dev/null || { left_out "no buildah"; return; }
  scripts/test_image.sh
}

step_format() {
  command -v clang-format >/dev/null || { left_out "no clang-format"; return; }
  scripts/format.sh --check
}

step_tidy() {
  local asked seen status=0
  command -v run-clang-tidy >/dev/null || { left_out "no clang-tidy"; return; }
  # clang does not read GCC's precompiled headers, and of sources that are compiled together only their wrapper would be known.
  cmake --preset release -B build/tidy -D CALIBRD_PCH=OFF -D CALIBRD_UNITY=OFF || return 1
  run-clang-tidy -quiet -p build/tidy "$kTidied" >build/clang-tidy.log 2>build/clang-tidy.err || status=$?
  grep -E '(warning|error): ' build/clang-tidy.log | sort -u
  asked=$(jq -r '.[].file' build/tidy/compile_commands.json | grep -E "^$kTidied" | sort -u | wc -l)
  seen=$(grep -e '-p=build/tidy ' build/clang-tidy.log | grep -oE "${kTidied}[^ ]+\.cpp$" | sort -u | wc -l)
  echo "clang-tidy ended with $status and looked at $seen of $asked sources (build/clang-tidy.log)"
  [ $status = 0 ] || tail -n 5 build/clang-tidy.err
  [ $status = 0 ] && [ "$asked" -gt 0 ] && [ "$seen" = "$asked" ] && ! grep -qE '(warning|error): ' build/clang-tidy.log
}

main() {
  local steps=("$@") failed=() passed=() without=() told step
  [ $# -gt 0 ] || steps=(release asan tsan faults image format tidy)
  scripts/setup.sh || exit 1
  for step in "${steps[@]}"; do
    declare -F "step_$step" >/dev/null || { echo "no step '$step'" >&2; exit 2; }
    echo "== $step"
    "step_$step"
    case $? in
      0) passed+=("$step") ;;
      "$kLeftOut") without+=("$step") ;;
      *) failed+=("$step") ;;
    esac
  done
  told="passed: ${passed[*]:-nothing}; left out: ${without[*]:-nothing}"
  [ ${#failed[@]} = 0 ] || { echo "failed: ${failed[*]}; $told"; exit 1; }
  echo "$told"
}

main "$@"
