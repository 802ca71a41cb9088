#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# The evidence that takes longer than scripts/test.sh may:
#   release   tests marked CONFIGURATIONS Deep (long tables, long runs)
#   asan      every test under the address and undefined-behaviour sanitizers
#   tsan      every test under the thread sanitizer
#   image     docker/Dockerfile, built and run with buildah (as root, when it is installed)
#   format    clang-format, in check mode     (when it is installed)
#   tidy      clang-tidy over every source    (when it is installed)
# usage: scripts/test_deep.sh [STEP...]   default: all of them; a failing step does not stop the next one
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 2

export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_stack_use_after_return=1:strict_string_checks=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-halt_on_error=1:print_stacktrace=1}
export TSAN_OPTIONS=${TSAN_OPTIONS:-halt_on_error=1:second_deadlock_stack=1:suppressions=$PWD/scripts/tsan.supp}

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

step_image() {
  command -v buildah >/dev/null || { echo "no buildah here: step left out"; return 0; }
  scripts/test_image.sh
}

step_format() {
  command -v clang-format >/dev/null || { echo "no clang-format here: step left out"; return 0; }
  scripts/format.sh --check
}

step_tidy() {
  command -v run-clang-tidy >/dev/null || { echo "no clang-tidy here: step left out"; return 0; }
  cmake --preset release -B build/tidy -D CALIBRD_PCH=OFF || return 1 # clang does not read GCC's precompiled headers
  run-clang-tidy -quiet -p build/tidy "$PWD/(core|drivers|api|server|config)/" >build/clang-tidy.log 2>/dev/null
  grep -E '(warning|error): ' build/clang-tidy.log | sort -u
  ! grep -qE '(warning|error): ' build/clang-tidy.log
}

main() {
  local steps=("$@") failed=()
  [ $# -gt 0 ] || steps=(release asan tsan image format tidy)
  scripts/setup.sh || exit 1
  for step in "${steps[@]}"; do
    declare -F "step_$step" >/dev/null || { echo "no step '$step'" >&2; exit 2; }
    echo "== $step"
    "step_$step" || failed+=("$step")
  done
  [ ${#failed[@]} = 0 ] || { echo "failed: ${failed[*]}"; exit 1; }
  echo "all passed: ${steps[*]}"
}

main "$@"
