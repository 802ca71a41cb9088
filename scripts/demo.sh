#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds calibrd, starts a simulated cell (robot controller and Kinect v2) and the daemon, calibrates once over
# HTTP and compares the pose with the simulator's true one. Works on a machine with nothing installed.
#   scripts/demo.sh            ends everything it started; exit status 0 when the pose is within 3 mm and 3 mrad
#   scripts/demo.sh --measure  also prints the processor time and the memory that the daemon takes
#   scripts/demo.sh --keep     leaves the cell and the daemon running, until Ctrl-C
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly kBin=build/release/bin kRobots=build/release/share/calibrd/robots kSensor=kinect2 kMaxMm=3 kMaxMrad=3
work=$(mktemp -d "${TMPDIR:-/tmp}/calibrd-demo.XXXXXX")
pids=()

clean_up() {
  local pid
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap clean_up EXIT
trap 'exit 130' INT TERM

die() {
  echo "demo: $*" >&2
  tail -n 20 "$work"/*.log >&2 2>/dev/null || true
  exit 1
}

# wait_for SECONDS WHAT COMMAND...: until the command succeeds; fails when a program of ours has ended.
wait_for() {
  local deadline=$((SECONDS + $1)) what=$2 pid
  shift 2
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $deadline ] || die "waited in vain for $what"
    for pid in "${pids[@]}"; do kill -0 "$pid" 2>/dev/null || die "a program ended while waiting for $what"; done
    sleep 0.1
  done
}

# 8080, as the README prints it, or any other port when that one is taken.
free_port() {
  python3 -c '
import socket
for port in (8080, 0):
    try:
        print(socket.create_server(("127.0.0.1", port)).getsockname()[1])
        break
    except OSError:
        pass'
}

build() {
  scripts/setup.sh
  cmake --preset release >"$work/cmake.log" || die "cmake failed"
  cmake --build --preset release --target demo
}

start_simulator() {
  "$kBin/calibrd-sim" run --world config/demo_cell/world.json --urdf "$kRobots/demo_arm7/urdf/demo_arm7.urdf" \
    --models "$kRobots" --world-file "$work/world" --controller-port 0 --control-port 0 --ready-file "$work/ready" \
    >/dev/null 2>"$work/simulator.log" &
  pids+=($!)
  wait_for 30 "the simulator" test -f "$work/ready"
  controller=$(sed -n 's/.*controller=127.0.0.1:\([0-9]*\).*/\1/p' "$work/ready")
  control=http://$(sed -n 's/.*control=\([^ ]*\).*/\1/p' "$work/ready")
}

start_daemon() {
  local port
  port=$(free_port)
  [ "$port" = 8080 ] || echo "Port 8080 is taken: the daemon listens on $port. Put $port wherever the README says 8080."
  CALIBRD_SIM_WORLD=$work/world "$kBin/calibrd" serve --config config/demo.toml --set server.port="$port" \
    --set robot.port="$controller" --set storage.path="$work/calibrd.db" >/dev/null 2>"$work/daemon.log" &
  pids+=($!)
  api=http://127.0.0.1:$port
  wait_for 30 "robot and sensor" curl -fsS "$api/readyz"
}

calibrate() {
  local job status shown=''
  echo "+ curl -X POST $api/api/v1/sensors/$kSensor/calibrations"
  job=$api$(curl -fsS -X POST "$api/api/v1/sensors/$kSensor/calibrations" -D - -o /dev/null |
    tr -d '\r' | sed -n 's/^[Ll]ocation: //p') || die "the calibration was refused"
  while curl -fsS "$job" -o "$work/job.json" || die "no answer from $job"; do
    status=$(jq -r '"\(.status) \(.message // "")"' "$work/job.json")
    [ "$status" = "$shown" ] || echo "  $status"
    shown=$status
    case $status in succeeded* | failed* | cancelled*) break ;; esac
    sleep 0.5
  done
  [ "$(jq -r .verdict "$work/job.json")" = accepted ] || die "not accepted: $(jq -c . "$work/job.json")"
}

# Prints both poses and their difference; fails when they are too far apart or the pose is not served as valid.
compare() {
  curl -fsS "$api/api/v1/sensors/$kSensor/pose" -o "$work/pose.json"
  curl -fsS "$control/truth" -o "$work/truth.json"
  jq -nr --arg id $kSensor --argjson max_mm $kMaxMm --argjson max_mrad $kMaxMrad \
    --slurpfile pose "$work/pose.json" --slurpfile truth "$work/truth.json" '
    def norm: map(. * .) | add | sqrt;
    def show: map("    " + (map(. * 1e6 | round / 1e6 | tostring | "           "[length:] + .) | join(" "))) | join("\n");
    $pose[0] as $p
    | if $p.valid then . else error("the pose is not valid: \($p.reason)") end
    | $p.T_base_sensor as $a
    | ($truth[0].sensors[] | select(.id == $id) | .T_base_sensor) as $b
    | ([range(3) | ($a[.][3] - $b[.][3]) * 1000] | norm) as $mm
    | (def D($i; $j): [range(3) | $a[.][$i] * $b[.][$j]] | add;   # of R_a^T R_b
       [D(2; 1) - D(1; 2), D(0; 2) - D(2; 0), D(1; 0) - D(0; 1)] | (norm / 2) | asin * 1000) as $mrad
    | "T_base_sensor, as served\n\($a | show)",
      "T_base_sensor, true\n\($b | show)",
      "difference: \($mm * 1000 | round / 1000) mm, \($mrad * 1000 | round / 1000) mrad"
      + "   (calibrd says: sigma \($p.sigma_position_m * 1e6 | round / 1e3) mm,"
      + " \($p.sigma_rotation_rad * 1e6 | round / 1e3) mrad)",
      if $mm <= $max_mm and $mrad <= $max_mrad then "the pose is true"
      else error("more than \($max_mm) mm or \($max_mrad) mrad off") end'
}

keep_running() {
  echo
  echo "daemon      curl $api/api/v1/sensors/$kSensor/pose"
  echo "            curl -X POST $api/api/v1/sensors/$kSensor/calibrations"
  echo "            curl '$api/readyz?verbose'"
  echo "simulator   $control/truth   knock the sensor:"
  echo "            curl -X POST $control/sensors/$kSensor/knock -d '{\"shift_m\": [0.02, 0, 0]}'"
  echo "Ctrl-C ends both."
  wait
}

case ${1:-} in '' | --keep | --measure) ;; *) die "unknown option '$1'. Options: --keep, --measure" ;; esac
build
start_simulator
start_daemon
calibrate
compare
case ${1:-} in
  --keep) keep_running ;;
  --measure) scripts/measure_live.sh "${pids[1]}" ;;
esac
