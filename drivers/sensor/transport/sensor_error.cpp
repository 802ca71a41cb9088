// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/sensor_error.hpp"

#include <cerrno>
#include <utility>

namespace calibrd {
namespace {

struct Row {
  SensorError error;
  const char* text;
};

constexpr Row kTexts[] = {
    {SensorError::invalid_settings,
     "this sensor setting cannot work; correct it in the configuration (docs/sensors.md lists the keys)"},
    {SensorError::program_missing,
     "calibrd-sensor could not be started; it belongs beside the calibrd binary: reinstall, or set the "
     "sensor's program to its path"},
    {SensorError::version_mismatch,
     "calibrd and calibrd-sensor are of different versions; reinstall both from one package and restart"},
    {SensorError::system_refused,
     "the system refused a resource the sensor needs; check its limits (open files, memory) and restart"},
    {SensorError::openni_failed,
     "OpenNI2 could not start; check that libopenni2-0 is installed and that the driver directory holds the "
     "sensor's driver as lib*.so.0 (docs/sensors.md)"},
    {SensorError::no_device,
     "no depth sensor matches; check the USB cable and the sensor's power, the udev rule, and that its "
     "OpenNI2 driver is among those tried (docs/sensors.md)"},
    {SensorError::open_failed,
     "the sensor is there but cannot be opened; close other programs that use it and check the permission on "
     "its USB device (udev rule, docs/sensors.md)"},
    {SensorError::no_depth_stream,
     "this device gives no depth; choose a depth sensor by its uri (calibrd-sensor --list shows all)"},
    {SensorError::mode_not_offered,
     "the sensor does not offer this size and rate; set width, height and fps to one of the modes listed"},
    {SensorError::stream_failed,
     "the sensor's stream could not be set up; unplug and replug the sensor, and update its driver if this "
     "comes back"},
    {SensorError::bad_frames,
     "the driver delivers other frames than it was asked for; set width and height to the sensor's own, and "
     "update its driver if this comes back"},
    {SensorError::disconnected,
     "the sensor was unplugged or lost its power; check cable and power supply, it is taken up again by "
     "itself"},
    {SensorError::silent,
     "the sensor is open but delivers no frames; check its power and that it has a USB port of its own, it "
     "is restarted by itself"},
    {SensorError::hung,
     "the sensor's driver stopped answering and is restarted; if this comes back, update the driver or move "
     "the sensor to a USB port of its own"},
    {SensorError::crashed,
     "the sensor's driver crashed and is restarted; if this comes back, update the driver"},
    {SensorError::recording_unreadable,
     "this recording cannot be played; check the path, that OpenNI2 wrote it, and that libOniFile.so.0 is "
     "among the drivers"},
    {SensorError::recording_ended, "the recording has ended; set loop = true to play it again and again"},
    {SensorError::ended_unasked,
     "calibrd-sensor ended without saying why and is restarted; run it by hand with --list to see what it "
     "says"},
};

const char* text(int value) {
  for (const auto& [error, text] : kTexts)
    if (static_cast<int>(error) == value) return text;
  return "unknown sensor error; calibrd and calibrd-sensor may be of different versions: reinstall both";
}

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "sensor"; }
  std::string message(int value) const override { return text(value); }
};

}  // namespace

const std::error_category& sensor_error_category() {
  static const Category category;
  return category;
}

std::error_code make_error_code(SensorError error) {
  return {static_cast<int>(error), sensor_error_category()};
}

Error sensor_error(SensorError error, std::string detail) {
  return {make_error_code(error), std::move(detail)};
}

Error system_error(const std::string& what) {
  const int number = errno;
  return sensor_error(SensorError::system_refused,
                      what + " (" + std::generic_category().message(number) + ")");
}

}  // namespace calibrd
