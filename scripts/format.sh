#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
#   scripts/format.sh           format the C++ sources in place
#   scripts/format.sh --check   only name the files that are not formatted; exit status 1 if there are any
# Formatting is defined by clang-format 14 (Debian 12's); other versions differ in details.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tool=$(command -v clang-format-14 || command -v clang-format) || {
  echo "format: no clang-format. Install it: apt-get install clang-format-14 (or clang-format)" >&2
  exit 2
}
"$tool" --version | grep -q 'version 14\.' || echo "format: $tool is not version 14; details may differ" >&2

mapfile -t files < <(find core drivers api fleet server config tests cmake -name '*.cpp' -o -name '*.hpp')
if [ "${1:-}" = --check ]; then
  "$tool" --dry-run --Werror "${files[@]}"
else
  "$tool" -i "${files[@]}"
fi
