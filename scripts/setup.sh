#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs what building and testing calibrd needs, from the distribution's own packages.
# Does nothing, and asks the network nothing, when all of it is there.
#   scripts/setup.sh           install what is missing (as root, or through sudo)
#   scripts/setup.sh --check   only say what is missing; exit status 1 if something is
#   scripts/setup.sh --list    print the packages
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly kTools=(g++ cmake ninja-build pkgconf ccache git ca-certificates curl jq python3)
readonly kLibraries=(
  libeigen3-dev libembree-dev libtbb-dev libnanoflann-dev                                # geometry
  liburdfdom-dev liburdfdom-headers-dev libassimp-dev libspng-dev libsqlite3-dev          # files
  libcli11-dev libspdlog-dev libtomlplusplus-dev libssl-dev libopenni2-dev
  libgtest-dev liborocos-kdl-dev)                                                         # tests
readonly kBoostPrefix=.deps/boost

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
  printf '%s\n' "${kTools[@]}" "${kLibraries[@]}"
  # Debian 12's is 1.74, which has no Boost.JSON: see need_private_boost.
  [ "$1" = debian:12 ] || echo libboost-dev
}

missing_packages() {
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 2>/dev/null | sed -n 's/^installed //p')
  packages "$1" | grep -vxF -f <(echo "$installed") || true
}

# Debian 12 has libboost1.81-dev, but it cannot be installed beside packages that need the default one (libpcl-dev,
# many of ROS): its headers go to a prefix of our own, where cmake/CalibrdBoost.cmake finds them.
need_private_boost() { [ "$1" = debian:12 ] && [ ! -f $kBoostPrefix/usr/include/boost/json.hpp ]; }

as_root() {
  if [ "$(id -u)" = 0 ]; then
    env DEBIAN_FRONTEND=noninteractive "$@"
  elif command -v sudo >/dev/null; then
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  else
    die "neither root nor sudo. Run as root: $*"
  fi
}

install_packages() {
  say "installing: $*"
  as_root apt-get update -qq
  as_root apt-get install -y -qq --no-install-recommends -o Dpkg::Use-Pty=0 "$@" >&2
}

download_boost() { (cd "$1" && apt-get download -qq -o APT::Sandbox::User="$(id -un)" libboost1.81-dev); }

unpack_boost() {
  say "unpacking libboost1.81-dev into $kBoostPrefix"
  local work
  mkdir -p .deps
  work=$(mktemp -d .deps/boost.XXXXXX)
  download_boost "$work" || { as_root apt-get update -qq && download_boost "$work"; } ||
    die "could not download libboost1.81-dev. Check the apt sources and the network, then run this again."
  dpkg -x "$work"/libboost1.81-dev_*.deb "$work/root"
  rm -rf $kBoostPrefix
  mv "$work/root" $kBoostPrefix # only now does it exist: an interrupted run leaves nothing half done
  rm -rf "$work"
}

refuse() {
  say "this is '$1'; packages are known for Debian 12, Debian 13 and Ubuntu 24.04."
  say "Elsewhere, install the like of these by hand (Boost >= 1.81), then: cmake --preset release"
  packages "$1" | xargs -n 8 echo "  " >&2
  exit 1
}

main() {
  local os missing
  os=$(distribution)
  [ "${1:-}" != --list ] || { packages "$os"; return; }
  case "$os" in
    debian:12 | debian:13 | ubuntu:24.04) ;;
    *) refuse "$os" ;;
  esac
  mapfile -t missing < <(missing_packages "$os")
  if [ "${1:-}" = --check ]; then
    if need_private_boost "$os"; then missing+=("$kBoostPrefix"); fi
    [ ${#missing[@]} = 0 ] || die "missing: ${missing[*]}"
    return
  fi
  [ $# = 0 ] || die "unknown option '$1'. Options: --check, --list"
  [ ${#missing[@]} = 0 ] || install_packages "${missing[@]}"
  if need_private_boost "$os"; then unpack_boost; fi
}

main "$@"
