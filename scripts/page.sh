#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Drives the page in Debian's Chromium against the daemon and the simulated cell. Build first (scripts/test.sh does);
# scripts/setup.sh --browser installs Chromium.
#   scripts/page.sh test               the tests in a browser; pictures go to build/release/page
#   scripts/page.sh figures [MINUTES]  prints the page's figures; memory is watched for so long (1; 30 to judge it), once it has settled
#   scripts/page.sh picture            makes docs/page.webp, the picture in the README (needs cwebp, of Debian's package webp)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

export CALIBRD_BUILD=${CALIBRD_BUILD:-$PWD/build/release}
export CALIBRD_PAGE_OUT=${CALIBRD_PAGE_OUT:-$CALIBRD_BUILD/page}

export CALIBRD_CHROMIUM=${CALIBRD_CHROMIUM:-/usr/bin/chromium}

need_browser() {
  [ -x "$CALIBRD_CHROMIUM" ] && return
  echo "page.sh: skipped, there is no $CALIBRD_CHROMIUM: scripts/setup.sh --browser installs it, CALIBRD_CHROMIUM names another" >&2
  exit 77 # what ctest takes for skipped
}

case ${1:-} in
  test | figures | picture) need_browser ;;&
  test)
    # One after the other: each has a cell of its own, and two of them are more than a small machine does in time.
    status=0
    for file in page doors desk; do node --test --test-reporter=spec "web/tests/$file.test.mjs" || status=1; done
    exit $status
    ;;
  figures) exec node web/tests/figures.mjs "${2:-1}" ;;
  picture)
    node web/tests/picture.mjs
    cwebp -quiet -q 80 "$CALIBRD_PAGE_OUT/picture.png" -o docs/page.webp
    ;;
  *)
    sed -n '7,9s/^# *//p' "$0" >&2
    exit 2
    ;;
esac
