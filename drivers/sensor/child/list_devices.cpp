// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/list_devices.hpp"

#include <cstdio>

#include "drivers/sensor/child/openni_device.hpp"
#include "drivers/sensor/child/surroundings.hpp"

namespace calibrd {
namespace {

void print_modes(OpenNiDevice& device, const char* name, openni::SensorType sensor) {
  const auto modes = device.modes(sensor);
  if (!modes.empty()) std::printf("  %-9s %s\n", name, describe(modes).c_str());
}

void print_device(const OpenNi& library, const OpenNi::Listed& listed) {
  std::printf("%s  %s\n", listed.uri.c_str(), listed.name.c_str());
  StreamRequest request;
  request.device = listed.uri;
  const auto device = OpenNiDevice::open(library, request);
  if (!device) {
    std::printf("  %s\n", device.error().message().c_str());
    return;
  }
  if (const auto serial = (*device)->serial(); !serial.empty())
    std::printf("  serial    %s\n", serial.c_str());
  print_modes(**device, "depth", openni::SENSOR_DEPTH);
  print_modes(**device, "infrared", openni::SENSOR_IR);
  print_modes(**device, "colour", openni::SENSOR_COLOR);
}

}  // namespace

int list_devices() {
  const auto library = OpenNi::start();
  if (!library) {
    std::fprintf(stderr, "%s\n", library.error().message().c_str());
    return 2;
  }
  const auto listed = (*library)->devices();
  for (const auto& device : listed) print_device(**library, device);
  if (listed.empty()) std::printf("%s\n", sensor_error(SensorError::no_device).message().c_str());
  std::printf("%s\n", describe_surroundings().c_str());
  return listed.empty() ? 3 : 0;
}

}  // namespace calibrd
