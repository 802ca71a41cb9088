// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/sensor_settings.hpp"

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {
namespace {

using std::chrono::milliseconds;

Status check(const SensorTimeouts& t) {
  const auto bad = [](const char* key) { return sensor_error(SensorError::invalid_settings, key); };
  if (t.open <= milliseconds(0)) return bad("open timeout is not positive");
  if (t.heartbeat < milliseconds(200)) return bad("heartbeat timeout is below 200 ms, two heartbeats");
  if (t.silence <= milliseconds(0)) return bad("silence timeout is not positive");
  if (t.restart_min <= milliseconds(0) || t.restart_max < t.restart_min)
    return bad("restart_min is not positive or exceeds restart_max");
  return Done{};
}

}  // namespace

Status check(const SensorProcessSettings& settings) {
  if (auto checked = check(settings.stream); !checked) return checked;
  if (!settings.openni_directory.empty()) {
    std::error_code ignored;
    const auto library = settings.openni_directory / "libOpenNI2.so.0";
    if (!std::filesystem::exists(library, ignored))
      return sensor_error(
          SensorError::invalid_settings,
          library.string() + " is missing (link the system's library there, put drivers beside it)");
  }
  return check(settings.timeouts);
}

}  // namespace calibrd
