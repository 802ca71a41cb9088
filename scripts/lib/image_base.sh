# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# The base image of docker/Dockerfile where no registry can be reached: a debootstrap of Debian 13, without what
# debian:13-slim leaves out. To be sourced, after lib/clean_root.sh.

# make_base_image NAME: imports it into buildah's store, when it is not there.
make_base_image() {
  local name=$1 archive container mount
  ! buildah inspect --type image "$name" >/dev/null 2>&1 || return 0
  archive=$(make_root_archive trixie) || return 1
  container=$(buildah from scratch)
  mount=$(buildah mount "$container")
  tar -C "$mount" -xf "$archive"
  (cd "$mount/usr/share" && rm -rf doc man info locale lintian)
  printf 'path-exclude /usr/share/%s/*\n' doc man info locale lintian >"$mount/etc/dpkg/dpkg.cfg.d/slim"
  buildah config --cmd bash "$container"
  buildah commit --quiet "$container" "$name" >/dev/null
  buildah rm "$container" >/dev/null
}
