#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds docker/Dockerfile with buildah, without a Docker engine, runs its image as the user it has, calibrates the
# simulated cell over HTTP, stops the daemon, starts it again and finds the pose; the collector's image is run as far as its
# version. As root; the first time takes an hour of processor time (a Debian 13 by debootstrap, calibrd built and its unit tests
# run in it).
#   scripts/test_image.sh               ends with 0 when all of it is as it should be
#   scripts/test_image.sh --no-tests    builds without the unit tests, in half the time
# It leaves the Debian 13 package that the image has installed in build/package-debian13.
# CALIBRD_BASE_IMAGE=debian:13-slim     takes that base instead of a debootstrap
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib/clean_root.sh
. scripts/lib/clean_root.sh
# shellcheck source=scripts/lib/image_base.sh
. scripts/lib/image_base.sh

readonly kUser=10001 kMostMb=250 kAuthorities=/etc/ssl/certs/ca-certificates.crt
readonly kRun=(buildah run --isolation chroot)
told_by=image api=http://127.0.0.1:8080 work='' watched='' containers=() pids=() daemon='' begin=''
# shellcheck source=scripts/lib/staged_run.sh
. scripts/lib/staged_run.sh

# Programs of the image that PID has started, PID itself among them.
descendants() {
  local child
  echo "$1"
  for child in $(pgrep -P "$1" || true); do descendants "$child"; done
}

# The one of them with that name.
program() {
  local pid
  for pid in $(descendants "$1"); do
    if [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = "$2" ]; then
      echo "$pid"
      return
    fi
  done
}

clean_up() {
  local pid container
  for pid in "${pids[@]}"; do
    # shellcheck disable=SC2046
    kill $(descendants "$pid") 2>/dev/null || true
  done
  wait 2>/dev/null || true
  for container in "${containers[@]}"; do buildah rm "$container" >/dev/null 2>&1 || true; done
  rm -rf "$work"
}

# build TARGET TAG
build() {
  local proxy=()
  # The page's packages may have to come through a proxy whose authority only this machine knows.
  [ ! -f "$kAuthorities" ] || proxy=(--volume "$kAuthorities:/run/authorities.crt:ro" --build-arg npm_config_cafile=/run/authorities.crt)
  say "builds $2"
  buildah build --isolation chroot --format docker --layers "${proxy[@]}" --build-arg "BASE=$base" --build-arg "TESTS=$tests" \
    --build-arg "REVISION=$(git rev-parse HEAD 2>/dev/null || echo unknown)" \
    --build-arg "npm_config_registry=$(npm config get registry 2>/dev/null || echo https://registry.npmjs.org/)" \
    --target "$1" --tag "$2" --file docker/Dockerfile . >>"$work/build.log" 2>&1 || die "buildah could not build $2"
}

# The .deb that is in it, for scripts/test_package.sh.
keep_package() {
  build build localhost/calibrd-build
  rm -rf build/package-debian13
  buildah from --name calibrd-test-build localhost/calibrd-build >/dev/null
  containers+=(calibrd-test-build)
  cp -r "$(buildah mount calibrd-test-build)/src/build/release/package" build/package-debian13
}

# What an engine would read of it.
check_image() {
  local size label
  size=$(buildah images --json localhost/calibrd | jq -r '.[0].size')
  say "size: $size"
  awk -v most=$kMostMb '{ exit !($2 == "MB" && $1 + 0 <= most) }' <<<"$size" || die "it is larger than $kMostMb MB"
  buildah inspect --type image localhost/calibrd | jq '.Docker.config' >"$work/config.json"
  for label in title description licenses version revision; do
    jq -e --arg key "org.opencontainers.image.$label" '.Labels[$key] | length > 0' "$work/config.json" >/dev/null ||
      die "it has no label $label"
  done
  jq -e --arg user "$kUser:$kUser" '.User == $user and .StopSignal == "SIGTERM" and .Healthcheck.Test[1] == "calibrd"
    and .Volumes["/data"] != null' "$work/config.json" >/dev/null || die "its configuration is $(cat "$work/config.json")"
}

# container NAME IMAGE: one whose root file system its user cannot write, as with --read-only
container() {
  local root
  buildah from --name "$1" "$2" >/dev/null
  containers+=("$1")
  root=$(buildah mount "$1")
  find "$root" -xdev -type d -perm -0002 -exec chmod 0755 {} +
  touch "$work/$1.made"
}

# What has changed in a container but the volumes, and what buildah puts there for every run.
changes() {
  local root
  root=$(buildah mount "$1")
  find "$root" -xdev \( -path "$root/data" -o -path "$root/world" -o -path "$root/proc" -o -path "$root/sys" -o -path "$root/dev" \
    -o -path "$root/run" -o -path "$root/etc" \) -prune -o -newercm "$work/$1.made" -print | sed "s|^$root||" | grep -v '^$' || true
}

start_cell() {
  "${kRun[@]}" --volume "$work/world:/world" calibrd-test-cell -- calibrd-sim run --world /usr/share/calibrd/world.json \
    --urdf /usr/share/calibrd/robots/demo_arm7/urdf/demo_arm7.urdf --models /usr/share/calibrd/robots \
    --world-file /world/world --controller-port 50241 --control-port 0 --ready-file /world/ready >"$work/cell.log" 2>&1 &
  pids+=($!)
  wait_for 60 "the simulated cell" test -f "$work/world/ready"
}

start_daemon() {
  begin=$(date +%s.%N)
  "${kRun[@]}" --volume "$work/world:/world" --volume "$work/data:/data" --env CALIBRD_SIM_WORLD=/world/world \
    --env CALIBRD_SERVER__ALLOW_UNAUTHENTICATED=true calibrd-test-daemon -- calibrd serve --config /config/calibrd.toml \
    >"$work/daemon.log" 2>&1 &
  watched=$!
  pids+=("$watched")
  wait_for 60 "robot and sensor" "${kRun[@]}" calibrd-test-daemon -- calibrd healthcheck --config /config/calibrd.toml --ready
  daemon=$(program "$watched" calibrd)
  [ "$(stat -c %u "/proc/$daemon")" = $kUser ] || die "the daemon does not run as its user"
}

# It can write what it has to although /data is all that it can write.
check_captures() {
  local job
  curl -fsS --json '{"postures": 1, "timeout_s": 60}' "$api/api/v1/sensors/$kSensor/captures" -o "$work/capture.tar" || die "no capture can be made"
  tar -tf "$work/capture.tar" | grep -q '/capture.json$' || die "the capture holds no capture.json"
  job=$(jq -r .calibration "$work/first.json")
  curl -fsS "$api/api/v1/calibrations/$job/capture" -o "$work/views.tar" || die "the views of the calibration are not kept"
}

# Until it has ended by itself, as `docker stop` has it.
stop_daemon() {
  local told
  told=$(date +%s.%N)
  kill -TERM "$daemon"
  wait "$watched" || die "the daemon did not end well"
  watched=''
  say "stopped in $(since "$told") s"
}

memory() {
  local pid sum=0
  for pid in $(descendants "$daemon"); do
    sum=$((sum + $(awk '/^Pss:/ { print $2 }' "/proc/$pid/smaps_rollup")))
  done
  echo $((sum / 1024))
}

# Without a configuration an image is of no use, and says so.
check_without_configuration() {
  buildah from --name calibrd-test-plain localhost/calibrd >/dev/null
  containers+=(calibrd-test-plain)
  ! "${kRun[@]}" calibrd-test-plain -- calibrd serve --config /config/calibrd.toml >"$work/plain.log" 2>&1 ||
    die "it starts without a configuration"
  grep -q '/config/calibrd.toml' "$work/plain.log" || die "it does not say what is missing"
  "${kRun[@]}" calibrd-test-plain -- sh -c '! command -v g++ && ! command -v node' >/dev/null || die "it ships what only building needs"
}

# Its program starts, with the libraries that are there, as the user that it has.
check_collector() {
  local config told
  config=$(buildah inspect --type image localhost/calibrd-collector | jq -r '.Docker.config.User + " " + .Docker.config.Entrypoint[0]')
  [ "$config" = "$kUser:$kUser calibrd-collector" ] || die "the collector's image runs $config"
  buildah from --name calibrd-test-collector localhost/calibrd-collector >/dev/null
  containers+=(calibrd-test-collector)
  told=$("${kRun[@]}" calibrd-test-collector -- calibrd-collector --version) || die "the collector does not start in its image"
  [[ "$told" =~ ^calibrd-collector\ [0-9]+\.[0-9]+ ]] || die "the collector says: $told"
}

tests=ON
case ${1:-} in '') ;; --no-tests) tests=OFF ;; *) echo "test_image.sh: unknown option '$1'. Options: --no-tests" >&2 && exit 2 ;; esac
work=$(mktemp -d "${TMPDIR:-/tmp}/calibrd-image.XXXXXX")
trap clean_up EXIT
trap 'exit 130' INT TERM
[ "$(id -u)" = 0 ] || cannot "buildah's chroot isolation takes root: sudo scripts/test_image.sh"
for tool in buildah curl jq; do command -v $tool >/dev/null || cannot "no $tool: apt-get install $tool"; done
[ -n "${CALIBRD_BASE_IMAGE:-}" ] || command -v debootstrap >/dev/null || cannot "no debootstrap: apt-get install debootstrap"
base=${CALIBRD_BASE_IMAGE:-localhost/calibrd-base}
[ -n "${CALIBRD_BASE_IMAGE:-}" ] || make_base_image "$base"
build daemon localhost/calibrd
build demo localhost/calibrd-demo
build collector localhost/calibrd-collector
keep_package
check_image
check_without_configuration
check_collector
chmod 755 "$work"
install -d -o $kUser -g $kUser -m 0700 "$work/world" "$work/data"
container calibrd-test-cell localhost/calibrd-demo
container calibrd-test-daemon localhost/calibrd-demo
start_cell
start_daemon
calibrate
say "from the start to the first valid pose: $(since "$begin") s; memory of the daemon and its child: $(memory) MiB"
check_captures
stop_daemon
start_daemon
find_pose_again
say "found again $(since "$begin") s after the second start"
stop_daemon
[ -z "$(changes calibrd-test-daemon)" ] || die "it wrote outside of /data: $(changes calibrd-test-daemon)"
say "passed"
