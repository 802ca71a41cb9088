# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# What the scripts that run calibrd-bench on random scenes begin with. To be sourced from the repository's root.
build=build/${CALIBRD_PRESET:-release}
bench=$build/bin/calibrd-bench

die() {
  echo "$(basename "$0"): $*" >&2
  exit 2
}

# Sets `robots` to the options that name the robots of the project to calibrd-bench and, with CALIBRD_SHARED_DATA set, the
# SIA5D in its models/. Ends the script when there is no calibrd-bench or no robot.
find_robots() {
  local name urdf models sia5d
  [ -x "$bench" ] || die "$bench is missing; run scripts/test.sh first"
  robots=()
  for name in demo_arm7 test_arm6; do
    for urdf in "$build"/{share/calibrd,tests}/robots/$name/urdf/$name.urdf; do
      [ -f "$urdf" ] && robots+=(--robot "$urdf")
    done
  done
  [ ${#robots[@]} -gt 0 ] || die "no robot in $build; run scripts/test.sh first"
  models=${CALIBRD_SHARED_DATA:+$CALIBRD_SHARED_DATA/models}
  sia5d=$models/motoman_sia5d_support/urdf/sia5d.urdf
  if [ -n "$models" ] && [ -f "$sia5d" ]; then robots+=(--robot "$sia5d" --models "$models"); fi
}
