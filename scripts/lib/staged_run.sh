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
