#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# What the daemon bears (docs/figures.md): with the simulated cell over its real links. JSON lines and a table.
#   scripts/load.sh throughput [SECONDS [ROUNDS]]        GET pose, 64 connections, against nginx; needs scripts/setup.sh --load
#   scripts/load.sh latency [SECONDS [RATE]]             GET pose at 500/s, open loop, while watching and calibrating
#   scripts/load.sh slow [SECONDS [SENDERS [READERS]]]   2000 slow senders and 500 slow readers beside 50 clients
#   scripts/load.sh flood [CONNECTIONS [LIMIT]]          10000 connections against a limit of 256
#   scripts/load.sh soak [HOURS [WARM_UP_HOURS]]         an hour of everyday work: does anything grow?
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=$PWD/build/${CALIBRD_PRESET:-release}
[ -x "$build/bin/calibrd" ] || { echo "load.sh: $build/bin/calibrd is missing; run scripts/test.sh first" >&2 && exit 2; }
what=${1:-}
case $what in
  throughput | latency | slow | flood | soak) shift && CALIBRD_BUILD=$build exec python3 -B "tests/load/$what.py" "$@" ;;
  *) echo "load.sh: unknown figure '$what'; see the head of scripts/load.sh" >&2 && exit 2 ;;
esac
