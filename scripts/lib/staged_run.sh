# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# What tests that install and run the daemon tell, and how they wait. To be sourced. Whoever sources it sets `told_by`, the
# name before each line, `work`, a folder whose *.log are shown when the test fails, and `watched`: a process that must live
# while something is waited for, or nothing.

say() { printf '%s: %4d s  %s\n' "$told_by" "$SECONDS" "$*" >&2; }

die() {
  say "FAILED: $*"
  tail -n 30 "$work"/*.log >&2 2>/dev/null || true
  exit 1
}

# What a run takes is not there. CALIBRD_SKIP_STATUS: whoever runs it counts that status as skipped.
cannot() {
  [ -n "${CALIBRD_SKIP_STATUS:-}" ] || die "$*"
  say "SKIPPED: $*"
  exit "$CALIBRD_SKIP_STATUS"
}

# wait_for SECONDS WHAT COMMAND...
wait_for() {
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $deadline ] || die "waited in vain for $what"
    [ -z "$watched" ] || kill -0 "$watched" 2>/dev/null || die "the daemon ended while waiting for $what"
    sleep 0.2
  done
}

# The following ask a daemon at $api for the sensor of the demo cell.
readonly kSensor=kinect2

since() { awk -v a="$1" -v b="$(date +%s.%N)" 'BEGIN { printf "%.1f", b - a }'; }

# answers PATH CONDITION. jq is content with no input at all.
answers() {
  local answer
  answer=$(curl -fsS "$api$1") && jq -e "$2" <<<"$answer"
}

# Leaves the pose in $work/first.json.
calibrate() {
  local job
  job=$(curl -fsS -X POST "$api/api/v1/sensors/$kSensor/calibrations" | jq -r .id) || die "a calibration was refused"
  wait_for 120 "the calibration" answers "/api/v1/calibrations/$job" '.status == "succeeded"'
  wait_for 10 "the pose" answers "/api/v1/sensors/$kSensor/pose" .valid
  curl -fsS "$api/api/v1/sensors/$kSensor/pose" -o "$work/first.json"
  jq -e .valid "$work/first.json" >/dev/null || die "the pose is not valid: $(cat "$work/first.json")"
}

# The same calibration, checked against the background, is good again.
find_pose_again() {
  wait_for 60 "the stored pose" answers "/api/v1/sensors/$kSensor/pose" .valid
  curl -fsS "$api/api/v1/sensors/$kSensor/pose" -o "$work/second.json"
  jq -es '.[0].calibration == .[1].calibration and
    ([.[0].T_base_sensor, .[1].T_base_sensor | flatten] | transpose | map(.[0] - .[1] | fabs) | max < 1e-9)' \
    "$work/first.json" "$work/second.json" >/dev/null || die "it is another pose: $(cat "$work/second.json")"
}
