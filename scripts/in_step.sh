#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# The figures of frames and joints in step (docs/figures.md), as JSON lines and a table.
#   scripts/in_step.sh            all of them, about 15 minutes
#   scripts/in_step.sh latency    time offsets of 0, 30 and 80 ms, injected over the real links
#   scripts/in_step.sh moving [SCENES [FIRST_SEED]]   views of the moving robot against still ones
#   scripts/in_step.sh step       from a controller's packet to the virtual cell in step
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=$PWD/build/${CALIBRD_PRESET:-release}
robots=("$build/share/calibrd/robots/demo_arm7/urdf/demo_arm7.urdf" "$build/tests/robots/test_arm6/urdf/test_arm6.urdf")

latency() { CALIBRD_BUILD=$build python3 -B tests/bench/latency.py 0 30 80; }

moving() {
  "$build/bin/calibrd-bench" moving --robot "${robots[0]}" --robot "${robots[1]}" --scenes "${1:-40}" \
    --first-seed "${2:-110001}" --uncorrected | tee /dev/stderr | python3 -B tests/bench/moving_table.py
}

step() {
  work=$(mktemp -d)
  "$build/bin/calibrd-sim" run --world config/demo_cell/world.json --urdf "${robots[0]}" \
    --models "$build/share/calibrd/robots" --world-file "$work/world" --controller-port 0 --control-port 0 \
    --ready-file "$work/ready" > /dev/null &
  simulator=$!
  trap 'kill $simulator; rm -rf "$work"' EXIT
  until [ -s "$work/ready" ]; do sleep 0.1; done
  port=$(sed 's/.*controller=127.0.0.1:\([0-9]*\).*/\1/' "$work/ready")
  "$build/bin/calibrd-bench" step "${robots[0]}" --models "$build/share/calibrd/robots" --port "$port" --seconds 60
}

case ${1:-all} in
  all) latency && moving && step ;;
  latency | moving | step) "$@" ;;
  *) echo "in_step.sh: unknown figure '$1'" >&2 && exit 2 ;;
esac
