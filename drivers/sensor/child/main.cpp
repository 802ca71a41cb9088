// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// calibrd-sensor: the only process that loads OpenNI2 and a vendor's driver. calibrd starts one for each
// sensor.
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "drivers/sensor/child/capture.hpp"
#include "drivers/sensor/child/list_devices.hpp"
#include "drivers/sensor/child/process_guard.hpp"
#include "drivers/sensor/transport/child_protocol.hpp"

namespace calibrd {
namespace {

constexpr int kStopped = 0, kUsage = 2, kFailed = 3;

RingGeometry geometry_of(const StreamRequest& request) {
  return {.width = request.width, .height = request.height, .with_image = request.image != ImageKind::none};
}

/// Says how it ended before the device is closed: closing goes through the driver and may hang.
int end(const Status& result, ParentLink& parent) {
  limit_time_to_end();
  if (result) return kStopped;
  parent.send(SensorFailure{static_cast<SensorError>(result.error().code.value()), result.error().detail});
  return kFailed;
}

int deliver_frames(const StreamRequest& request, ParentLink& parent) {
  auto ring = FrameRingWriter::attach(kRingFd, geometry_of(request));
  if (!ring) return end(ring.error(), parent);
  auto library = OpenNi::start();
  if (!library) return end(library.error(), parent);
  Capture capture(request);
  auto result = capture.open(**library);
  if (result) result = capture.run(*ring, parent);
  const int status = end(result, parent);
  // A file needs no closing, and OpenNI2's player can crash in it: its thread may still read.
  if (!request.recording.empty()) std::_Exit(status);
  return status;
}

int serve(pid_t parent_id, std::span<const std::string> arguments) {
  install_stop_signal();
  if (!end_with_parent(parent_id)) return kStopped;
  ParentLink parent(kMessageFd, kWakeFd);
  parent.send(SensorHello{});
  const auto request = request_from_arguments(arguments);
  return request ? deliver_frames(*request, parent) : end(request.error(), parent);
}

int usage() {
  std::fputs(
      "calibrd-sensor is started by calibrd, one process for each sensor.\n"
      "By hand: calibrd-sensor --list   shows the sensors OpenNI2 finds, and where it looked\n",
      stderr);
  return kUsage;
}

pid_t parsed_parent(const std::string& argument) {
  const std::string text =
      argument.starts_with(kParentArgument) ? argument.substr(kParentArgument.size()) : "";
  pid_t parent = 0;
  std::from_chars(text.data(), text.data() + text.size(), parent);
  return parent;
}

int run(std::span<const std::string> arguments) {
  if (arguments.size() == 1 && arguments[0] == "--list") return list_devices();
  const pid_t parent = arguments.empty() ? 0 : parsed_parent(arguments[0]);
  return parent > 0 ? serve(parent, arguments.subspan(1)) : usage();
}

}  // namespace
}  // namespace calibrd

int main(int argc, char** argv) { return calibrd::run(std::vector<std::string>(argv + 1, argv + argc)); }
