#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Prints the share of one core and the memory of a running daemon and its sensor processes.
# usage: scripts/measure_live.sh PID [SECONDS]     default: 20 s
set -euo pipefail
[ $# -ge 1 ] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
readonly kPid=$1 kSeconds=${2:-20}
[ -r "/proc/$kPid/stat" ] || { echo "measure_live: there is no process $kPid; pgrep -x calibrd names the daemon's" >&2; exit 2; }
[[ $kSeconds =~ ^[1-9][0-9]*$ ]] || { echo "measure_live: '$kSeconds' is no number of seconds" >&2; exit 2; }

family() { echo "$kPid" "$(cat /proc/"$kPid"/task/*/children 2>/dev/null)"; }

# User and system time of a process, in clock ticks; the name in parentheses may hold spaces.
ticks() { sed 's/.*) //' "/proc/$1/stat" | awk '{ print $12 + $13 }'; }

declare -A before
for pid in $(family); do before[$pid]=$(ticks "$pid"); done
sleep "$kSeconds"
hz=$(getconf CLK_TCK)
for pid in $(family); do
  [ -n "${before[$pid]:-}" ] || continue
  used=$(($(ticks "$pid") - before[$pid]))
  awk -v name="$(cat "/proc/$pid/comm")" -v pid="$pid" -v used="$used" -v hz="$hz" -v s="$kSeconds" '
    /^(VmRSS|VmHWM|RssAnon)/ { mb[$1] = $2 / 1024 }
    END { printf "%-16s pid %-7d %5.1f %% of a core   RSS %.0f MB (own %.0f MB, highest %.0f MB)\n",
          name, pid, 100 * used / hz / s, mb["VmRSS:"], mb["RssAnon:"], mb["VmHWM:"] }' "/proc/$pid/status"
done
