#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs a .deb with apt into a clean root, as an earlier version; calibrates a simulated cell there with the daemon running
# as its user; upgrades it, finds the pose again; purges it. As root.
#   scripts/test_package.sh                builds the .deb, and takes a root of this machine's Debian or Ubuntu release
#   scripts/test_package.sh FILE SUITE     takes that .deb and a root of that release; of Debian 13, as scripts/test_image.sh
#                                          leaves it:  build/package-debian13/calibrd_*.deb trixie
#   scripts/test_package.sh --build-only   prints the path of the .deb
# CALIBRD_PRESET=debug takes another preset, KEEP=1 leaves the root where it is. Packages come from the apt sources of this machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly kBuild=build/${CALIBRD_PRESET:-release} kHealthcheck=(/usr/bin/calibrd healthcheck)
readonly kEnvironment=(PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive)
readonly kAsDaemon=(setpriv --reuid calibrd --regid calibrd --init-groups --no-new-privs --inh-caps=-all)
told_by=package api='' work='' root='' pids=() watched=''
# shellcheck source=scripts/lib/staged_run.sh
. scripts/lib/staged_run.sh
# shellcheck source=scripts/lib/clean_root.sh
. scripts/lib/clean_root.sh

clean_up() {
  local pid
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
  [ -n "$root" ] || return 0
  if mountpoint -q "$root/proc"; then umount "$root/proc"; fi
  if [ "${KEEP:-}" = 1 ]; then
    say "the root is $root"
  else
    rm -rf --one-file-system "$work"
  fi
}

build() {
  scripts/setup.sh
  cmake --preset "${CALIBRD_PRESET:-release}" >&2
  cmake --build "$kBuild" --target calibrd calibrd-sensor calibrd_pcl web >&2
  rm -rf "$kBuild/package"
  (cd "$kBuild" && cpack -G DEB) >&2 || die "cpack failed"
  deb=$(ls "$kBuild"/package/calibrd_*.deb)
}

# The first of this machine's sources for its release; whatever mirror that is.
own_mirror() {
  # shellcheck disable=SC2016 # apt's own variables
  apt-get indextargets --format '$(SITE) $(RELEASE) $(COMPONENT)' 'Identifier: Packages' |
    awk -v suite="$1" '$2 == suite && $3 == "main" { print $1; exit }' |
    grep . || die "no apt source for this machine's release; see /etc/apt/sources.list.d"
}

# make_root SUITE
make_root() {
  local suite=$1 archive own_suite
  # shellcheck source=/dev/null
  own_suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
  say "a clean root of $suite"
  [ "$suite" != "$own_suite" ] || CALIBRD_DEBIAN_MIRROR=${CALIBRD_DEBIAN_MIRROR:-$(own_mirror "$suite")}
  archive=$(make_root_archive "$suite" 2>"$work/debootstrap.log") || die "debootstrap failed"
  mkdir "$root" && tar -C "$root" -xf "$archive"
  [ "$suite" != "$own_suite" ] || copy_apt_sources
  copy_authorities
  mount -t proc proc "$root/proc"
  echo '#!/bin/sh
exit 101' >"$root/usr/sbin/policy-rc.d" # nothing is started on installation
  chmod +x "$root/usr/sbin/policy-rc.d"
}

# All of the machine's sources for the release, its proxies and keys with them: updates count for versions.
copy_apt_sources() {
  rm -f "$root/etc/apt/sources.list"
  cp -aL /etc/apt/. "$root/etc/apt/"
  mkdir -p "$root/usr/share/keyrings"
  cp -aL /usr/share/keyrings/. "$root/usr/share/keyrings/"
}

copy_authorities() {
  cp -aL /etc/ssl/certs /etc/resolv.conf "$work/" 2>/dev/null || true
  mkdir -p "$root/etc/ssl" && cp -a "$work/certs" "$root/etc/ssl/"
  [ ! -f "$work/resolv.conf" ] || cp "$work/resolv.conf" "$root/etc/resolv.conf"
}

in_root() { env -i "${kEnvironment[@]}" chroot "$root" "$@"; }

as_daemon() { in_root "${kAsDaemon[@]}" "$@"; }

# Everything in the root but what packages' tools write for themselves.
inventory() {
  (cd "$root" && find . -xdev \( -path ./proc -o -path ./var/cache -o -path ./var/lib/apt -o -path ./var/lib/dpkg \
    -o -path ./var/log -o -path ./tmp \) -prune -o -print | sort)
}

# As dpkg meets it when it upgrades: another version, with other defaults.
make_earlier() {
  dpkg-deb -R "$deb" "$work/parts"
  sed -i 's/^Version: .*/Version: 0.0.1-1/' "$work/parts/DEBIAN/control"
  echo '# A default of an earlier version.' >>"$work/parts/etc/calibrd/calibrd.toml"
  earlier=$work/calibrd_0.0.1-1.deb
  dpkg-deb --root-owner-group -b "$work/parts" "$earlier" >/dev/null
  rm -r "$work/parts"
}

# install_package FILE
install_package() {
  local deb=$1
  say "apt installs $(basename "$deb")"
  in_root apt-get update -qq >"$work/apt.log" 2>&1 || die "apt-get update failed"
  local dependencies
  mkdir -p "$root/tmp/deb" && cp "$deb" "$root/tmp/deb/"
  # Its dependencies first, so that what the package itself leaves behind can be told from what they do.
  dependencies=$(in_root apt-get install -s --no-install-recommends "/tmp/deb/$(basename "$deb")" |
    awk '$1 == "Inst" && $2 != "calibrd" { print $2 }')
  # shellcheck disable=SC2086
  in_root apt-get install -y -qq --no-install-recommends $dependencies >>"$work/apt.log" 2>&1 || die "apt failed"
  cp "$root/etc/passwd" "$work/passwd" && cp "$root/etc/group" "$work/group"
  inventory >"$work/before"
  in_root apt-get install -y -qq --no-install-recommends "/tmp/deb/$(basename "$deb")" >>"$work/apt.log" 2>&1 ||
    die "apt failed"
  # shellcheck disable=SC2016
  say "installed: $(in_root dpkg-query -W -f '${Version}, ${Installed-Size} KiB' calibrd); with it $(wc -w <<<"$dependencies") packages"
}

check_unit() {
  local missing exposure
  in_root ldd /usr/bin/calibrd /usr/bin/calibrd-sensor /usr/lib/calibrd/libcalibrd_pcl.so | grep 'not found' && die "a library is missing"
  [ "$(in_root id -nG calibrd)" = "calibrd video" ] || die "the user is: $(in_root id calibrd)"
  [ "$(in_root stat -c '%U %a' /var/lib/calibrd)" = "calibrd 750" ] || die "/var/lib/calibrd is not its own"
  command -v systemd-analyze >/dev/null || { say "no systemd-analyze here: the unit is not checked"; return; }
  # Of what it says of this unit alone: a minimal root lacks units that others name, and an older systemd than its own does not know
  # all that they hold. Not by "calibrd", which the path of every unit in the root has in it.
  missing=$(systemd-analyze verify --root="$root" --man=no "$root/usr/lib/systemd/system/calibrd.service" 2>&1 | grep -F calibrd.service || true)
  [ -z "$missing" ] || die "systemd-analyze verify: $missing"
  exposure=$(systemd-analyze security --offline=true --root="$root" --no-pager calibrd.service | tail -n 1)
  say "systemd-analyze security: ${exposure#→ }"
  systemd-analyze security --offline=true --root="$root" --no-pager --threshold=30 calibrd.service >/dev/null ||
    die "the unit is more exposed than 3.0"
  # In a copy: what enabling leaves is no part of the inventory. It is not started: no systemd runs in the root.
  install -D -t "$work/enabled/usr/lib/systemd/system" "$root/usr/lib/systemd/system/calibrd.service"
  systemctl --root="$work/enabled" --quiet enable calibrd.service 2>"$work/enable.log" || die "the unit cannot be enabled"
  [ -L "$work/enabled/etc/systemd/system/multi-user.target.wants/calibrd.service" ] || die "the unit, enabled, is wanted by nothing"
}

# The simulator stays outside; what it shows of itself, and the sensor's driver, are put into the root as a user would.
bring_cell() {
  local robots=$kBuild/share/calibrd/robots folder=$root/srv/cell
  cmake --build "$kBuild" --target calibrd-sim calibrd_sim demo_robot >"$work/build.log" 2>&1 || die "no simulator: $(tail -n 3 "$work/build.log")"
  mkdir -p "$folder/openni/OpenNI2/Drivers"
  cp -r "$robots/demo_arm7" "$folder/demo_arm7"
  cp "$kBuild/lib/calibrd-sim-openni/OpenNI2/Drivers/libcalibrd_sim.so.0" "$folder/openni/OpenNI2/Drivers/"
  ln -s "$(in_root sh -c 'ls /usr/lib/*/libOpenNI2.so.0')" "$folder/openni/libOpenNI2.so.0"
  "$kBuild/bin/calibrd-sim" run --world config/demo_cell/world.json --urdf "$robots/demo_arm7/urdf/demo_arm7.urdf" \
    --models "$robots" --world-file "$folder/world" --controller-port 0 --control-port 0 --ready-file "$work/ready" \
    >/dev/null 2>"$work/simulator.log" &
  pids+=($!)
  wait_for 60 "the simulator" test -f "$work/ready"
  chmod -R a+rX "$folder"
}

# As an integrator would: dpkg must leave it alone, and purge must remove it.
edit_configuration() {
  local port
  port=$(python3 -c 'import socket; print(socket.create_server(("127.0.0.1", 0)).getsockname()[1])')
  api=http://127.0.0.1:$port
  sed -i -e "s|^# port = 8080|port = $port|" -e 's|^urdf = .*|urdf = "/srv/cell/demo_arm7/urdf/demo_arm7.urdf"|' \
    -e 's|^host = .*|host = "127.0.0.1"|' -e "s|^# port = 50241.*|port = $(sed -n 's/.*controller=127.0.0.1:\([0-9]*\).*/\1/p' "$work/ready")|" \
    -e 's|^# uri = .*|driver_directory = "/srv/cell/openni"|' "$root/etc/calibrd/calibrd.toml"
  cp "$root/etc/calibrd/calibrd.toml" "$work/edited.toml"
}

# What docs/deployment.md has one ask before the first start.
check_first_steps() {
  local status=0
  as_daemon calibrd-sensor --list >"$work/list.log" 2>&1 || status=$?
  if [ $status = 3 ]; then
    grep -q 'no depth sensor matches' "$work/list.log" || die "calibrd-sensor --list does not say that there is no sensor"
  else
    [ $status = 0 ] || die "calibrd-sensor --list ends with status $status"
  fi
  as_daemon calibrd serve --check-config >"$work/check.log" 2>&1 || die "the configuration is refused"
}

start_daemon() {
  ! as_daemon "${kHealthcheck[@]}" 2>"$work/healthcheck.log" || die "something answers before the daemon runs"
  # Not by as_daemon: a function in the background is a shell, whose end is not the daemon's.
  env -i "${kEnvironment[@]}" CALIBRD_SIM_WORLD=/srv/cell/world chroot "$root" "${kAsDaemon[@]}" \
    /usr/bin/calibrd serve --config /etc/calibrd/calibrd.toml \
    >"$work/daemon.log" 2>&1 &
  watched=$! && pids+=("$watched")
  wait_for 60 "life" as_daemon "${kHealthcheck[@]}"
  wait_for 60 "robot and sensor" as_daemon "${kHealthcheck[@]}" --ready
  [ "$(stat -c %u "/proc/$watched")" = "$(in_root id -u calibrd)" ] || die "it does not run as its user"
  in_root stat -c %U /var/lib/calibrd/calibrd.db | grep -qx calibrd || die "it keeps no database of its own"
}

stop_daemon() {
  kill -TERM "$watched"
  wait "$watched" || die "it did not end well"
  watched=''
}

upgrade() {
  say "apt upgrades it"
  # What unattended upgrades are told where the default and the administrator have both changed a file.
  in_root apt-get install -y -qq --no-install-recommends -o Dpkg::Options::=--force-confold "/tmp/deb/$(basename "$deb")" \
    >>"$work/apt.log" 2>&1 || die "apt could not upgrade it"
  # shellcheck disable=SC2016
  [ "$(in_root dpkg-query -W -f '${Version}' calibrd)" = "$(dpkg-deb -f "$deb" Version)" ] || die "it is still the earlier version"
  cmp "$work/edited.toml" "$root/etc/calibrd/calibrd.toml" || die "the upgrade has changed the configuration"
  [ -f "$root/etc/calibrd/calibrd.toml.dpkg-dist" ] || die "the new defaults are nowhere"
}

purge() {
  say "apt purges it"
  rm -rf "$root/srv/cell"
  in_root apt-get purge -y -qq calibrd >>"$work/apt.log" 2>&1 || die "apt could not purge it"
  inventory >"$work/after"
  diff "$work/before" "$work/after" >&2 || die "the purge left that (> new, < gone)"
  if ! diff "$work/passwd" "$root/etc/passwd" >&2 || ! diff "$work/group" "$root/etc/group" >&2; then
    die "its user is still there"
  fi
}

case "${1:-} $#" in
  ' 0' | '--build-only 1') ;;
  -* | *' 1') sed -n '7,12s/^# *//p' "$0" >&2 && exit 2 ;;
esac
if [ "${1:-}" = --build-only ]; then
  build
  echo "$deb"
  exit
fi
[ "$(id -u)" = 0 ] || cannot "a root of its own takes root: sudo scripts/test_package.sh"
for tool in debootstrap curl jq; do command -v $tool >/dev/null || cannot "no $tool: apt-get install $tool"; done
unshare --mount true 2>/dev/null || cannot "this machine lets nobody mount anything: run it on one of its own, or in a container that may"
work=$(mktemp -d "${TMPDIR:-/tmp}/calibrd-package.XXXXXX")
root=$work/root
trap clean_up EXIT
trap 'exit 130' INT TERM
if [ $# = 0 ]; then
  build
  # shellcheck source=/dev/null
  suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
else
  deb=$1 suite=$2
  [ -f "$deb" ] || die "there is no $deb"
fi
say "$(basename "$deb"), $(($(stat -c %s "$deb") / 1024)) KiB"
make_root "$suite"
make_earlier
mkdir -p "$root/tmp/deb" && cp "$deb" "$root/tmp/deb/"
install_package "$earlier"
check_unit
bring_cell
edit_configuration
check_first_steps
say "the daemon runs as its user"
start_daemon
calibrate
stop_daemon
upgrade
start_daemon
find_pose_again
say "the upgraded daemon serves the pose that the earlier one found"
stop_daemon
purge
say "passed"
