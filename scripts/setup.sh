#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs what building and testing calibrd needs, from the distribution's own packages.
# Does nothing, and asks the network nothing, when all of it is there.
#   scripts/setup.sh           install what is missing (as root, or through sudo)
#   scripts/setup.sh --check   only say what is missing; exit status 1 if something is
#   scripts/setup.sh --list    print the packages
#   scripts/setup.sh --fuzz    install what fuzzing needs as well (clang, 300 MB); scripts/fuzz.sh does so
#   scripts/setup.sh --browser install what scripts/page.sh drives the page with as well (Chromium)
#   scripts/setup.sh --fleet   install what the fleet's tests run against as well (mosquitto, PostgreSQL)
#   scripts/setup.sh --load    install what scripts/load.sh throughput compares with as well (wrk, nginx)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly kTools=(g++ cmake ninja-build pkgconf ccache git ca-certificates curl jq python3)
readonly kLibraries=(
  libeigen3-dev libembree-dev libtbb-dev libnanoflann-dev                                # geometry
  liburdfdom-dev liburdfdom-headers-dev libconsole-bridge-dev libassimp-dev libspng-dev libsqlite3-dev          # files
  libcli11-dev libspdlog-dev libtomlplusplus-dev libssl-dev libopenni2-dev
  libmosquitto-dev libpq-dev                                                              # fleet
  libboost-dev # headers; for PCL, and where it is new enough for all of calibrd
  libgtest-dev liborocos-kdl-dev python3-jsonschema libfaketime)                          # tests
readonly kPage=(nodejs npm) # a Node.js of one's own, 18 or newer, serves as well
readonly kNpm=(web tests/deploy)
readonly kBrowser=(chromium)  # Ubuntu has it only as a snap
readonly kFuzzing=(clang libclang-rt-dev) # libFuzzer is in the runtime of the default version
readonly kFleet=(mosquitto mosquitto-clients postgresql)
readonly kLoad=(wrk nginx-light)
readonly kBoostPrefix=.deps/boost
readonly kPclPrefix=.deps/pcl

say() { echo "setup: $*" >&2; }

die() {
  say "$*"
  exit 1
}

# Prints the distribution as ID:VERSION_ID, for example debian:12.
distribution() {
  (
    # shellcheck source=/dev/null
    . "${CALIBRD_OS_RELEASE:-/etc/os-release}" 2>/dev/null || true
    echo "${ID:-unknown}:${VERSION_ID:-}"
  )
}

packages() {
  printf '%s\n' "${kTools[@]}" "${kLibraries[@]}" "${extra[@]}"
  has_node || printf '%s\n' "${kPage[@]}"
}

has_node() { [ "$(node --version 2>/dev/null | sed 's/v\([0-9]*\).*/\1/')" -ge 18 ] 2>/dev/null && command -v npm >/dev/null; }

# Folders with packages of npm, exactly those of their lock files; without running anything of theirs. npm writes down what
# it has installed: as long as that is newer than the lock file, nothing is to be done.
need_npm_packages() { [ "$1/package-lock.json" -nt "$1/node_modules/.package-lock.json" ]; }

# install_npm_packages FOLDER CONSEQUENCE
install_npm_packages() {
  say "installing packages into $1/node_modules"
  # Not npm ci: it refuses a lock file without rollup's builds for other platforms, which not every registry holds.
  (cd "$1" && npm install --no-save --ignore-scripts --no-audit --no-fund --loglevel=error >&2) || say "npm could not: $2"
}

missing_packages() {
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 2>/dev/null | sed -n 's/^installed //p')
  packages | grep -vxF -f <(echo "$installed") || true
}

# Debian 12's libboost-dev is 1.74, without Boost.JSON. It has libboost1.81-dev as well, which cannot be installed beside
# the default one: its headers go to a prefix of our own, where cmake/CalibrdBoost.cmake finds them.
need_private_boost() { [ "$1" = debian:12 ] && [ ! -f $kBoostPrefix/usr/include/boost/json.hpp ]; }

# libpcl-dev needs all of PCL, VTK and Qt (1.3 GB). Its headers and FLANN's go to a prefix of our own, where
# cmake/CalibrdPcl.cmake finds them; of the libraries, those that are used are installed. An installed libpcl-dev serves.
need_private_pcl() {
  ! compgen -G '/usr/include/pcl-*/pcl/registration/icp.h' >/dev/null &&
    ! { [ -f $kPclPrefix/usr/include/flann/util/params.h ] && ls /usr/lib/*/libpcl_filters.so.* >/dev/null 2>&1; }
}

as_root() {
  if [ "$(id -u)" = 0 ]; then
    env DEBIAN_FRONTEND=noninteractive "$@"
  elif command -v sudo >/dev/null; then
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  else
    die "neither root nor sudo. Run as root: $*"
  fi
}

# Once is enough: it takes longer than most packages do.
update_lists() {
  [ -z "${lists_are_new:-}" ] || return 0
  as_root apt-get update -qq && lists_are_new=1
}

install_packages() {
  say "installing: $*"
  update_lists
  as_root apt-get install -y -qq --no-install-recommends -o Dpkg::Use-Pty=0 "$@" >&2
}

# Puts the files of packages into a prefix, without installing them: unpack PREFIX PACKAGE...
unpack() {
  local prefix=$1 work package
  shift
  say "unpacking $* into $prefix"
  mkdir -p .deps
  work=$(mktemp -d "$prefix.XXXXXX")
  download "$work" "$@" || { update_lists && download "$work" "$@"; } ||
    die "could not download $*. Check the apt sources and the network, then run this again."
  for package in "$work"/*.deb; do dpkg -x "$package" "$work/root"; done
  if [ "$prefix" = $kPclPrefix ]; then install_pcl_library "$work"/libpcl-dev_*.deb; fi
  rm -rf "$prefix"
  mv "$work/root" "$prefix" # only now does it exist: an interrupted run leaves nothing half done
  rm -rf "$work"
}

download() { (cd "$1" && shift && apt-get download -qq -o APT::Sandbox::User="$(id -un)" "$@"); }

# The library that the headers in this libpcl-dev are for has their version in its name; it brings those it needs.
install_pcl_library() {
  local library
  library=$(dpkg-deb -f "$1" Depends | grep -oE 'libpcl-filters[^ ,]*')
  install_packages "$library"
}

refuse() {
  say "this is '$1'; packages are known for Debian 12, Debian 13 and Ubuntu 24.04."
  say "Elsewhere, install the like of these by hand (Boost >= 1.81), then: cmake --preset release"
  packages | xargs -n 8 echo "  " >&2
  exit 1
}

main() {
  local os missing folder extra=()
  os=$(distribution)
  case ${1:-} in
    --fuzz) extra=("${kFuzzing[@]}") && shift ;;
    --fleet) extra=("${kFleet[@]}") && shift ;;
    --load) extra=("${kLoad[@]}") && shift ;;
    --browser) extra=("${kBrowser[@]}") && shift ;;
  esac
  [ "${1:-}" != --list ] || { packages; return; }
  case "$os" in
    debian:12 | debian:13 | ubuntu:24.04) ;;
    *) refuse "$os" ;;
  esac
  mapfile -t missing < <(missing_packages)
  if [ "${1:-}" = --check ]; then
    if need_private_boost "$os"; then missing+=("$kBoostPrefix"); fi
    if need_private_pcl; then missing+=("$kPclPrefix"); fi
    for folder in "${kNpm[@]}"; do
      if need_npm_packages "$folder"; then missing+=("$folder/node_modules"); fi
    done
    [ ${#missing[@]} = 0 ] || die "missing: ${missing[*]}"
    return
  fi
  [ $# = 0 ] || die "unknown option '$1'. Options: --check, --list, --fleet, --fuzz, --load, --browser"
  [ ${#missing[@]} = 0 ] || install_packages "${missing[@]}"
  if need_private_boost "$os"; then unpack $kBoostPrefix libboost1.81-dev; fi
  if need_private_pcl; then unpack $kPclPrefix libpcl-dev libflann-dev; fi
  if need_npm_packages web; then install_npm_packages web "the daemon is built without its page"; fi
  if need_npm_packages tests/deploy; then install_npm_packages tests/deploy "the manifests are not tested"; fi
}

main "$@"
