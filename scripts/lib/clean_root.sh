# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# A Debian with nothing but the minimum, made by debootstrap, to be sourced. It is kept in build/roots and copied from
# there. Takes Debian from where this machine's apt takes it, or from CALIBRD_DEBIAN_MIRROR.

debian_mirror() {
  if [ -n "${CALIBRD_DEBIAN_MIRROR:-}" ]; then
    echo "$CALIBRD_DEBIAN_MIRROR"
  else
    apt-get indextargets --format '$(REPO_URI)' | grep -vE 'security|ubuntu' | sort -u | head -n 1 | grep . ||
      echo http://deb.debian.org/debian
  fi
}

# make_root_archive SUITE: prints the name of build/roots/SUITE.tar, made when it is not there.
make_root_archive() {
  local suite=$1 archive=build/roots/$1.tar root
  if [ ! -f "$archive" ]; then
    command -v debootstrap >/dev/null || { echo "debootstrap is missing: apt-get install debootstrap" >&2; return 1; }
    mkdir -p build/roots
    root=$(mktemp -d build/roots/making.XXXXXX)
    chmod 755 "$root" # every user looks in
    # In a mount namespace of its own: what debootstrap mounts goes with it.
    unshare --mount debootstrap --variant=minbase "$suite" "$root" "$(debian_mirror)" >&2 || return 1
    # What this machine needs to reach that mirror, as a proxy; a password in it would be kept in the archive, which stays here.
    cp /etc/apt/apt.conf.d/99* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
    rm -rf "$root"/var/cache/apt/archives/*.deb "$root"/var/lib/apt/lists/*
    tar -C "$root" --one-file-system -cf "$archive.part" .
    rm -rf --one-file-system "$root"
    mv "$archive.part" "$archive"
  fi
  echo "$archive"
}
