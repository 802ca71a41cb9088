// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <system_error>

#include "core/base/result.hpp"

namespace calibrd {

/// Why there are no frames. The values cross the process border: append, never renumber.
enum class SensorError : std::uint16_t {
  invalid_settings = 1,
  program_missing = 2,
  version_mismatch = 3,
  system_refused = 4,
  openni_failed = 5,
  no_device = 6,
  open_failed = 7,
  no_depth_stream = 8,
  mode_not_offered = 9,
  stream_failed = 10,
  bad_frames = 11,
  disconnected = 12,
  silent = 13,
  hung = 14,
  crashed = 15,
  recording_unreadable = 16,
  recording_ended = 17,
  ended_unasked = 18,
};
inline constexpr std::uint16_t kLastSensorError = 18;

const std::error_category& sensor_error_category();
std::error_code make_error_code(SensorError error);

/// An Error of this module. `detail` names the key, file or device at fault.
Error sensor_error(SensorError error, std::string detail = {});

/// The same for a failed system call: `what` was tried, errno says why it failed.
Error system_error(const std::string& what);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::SensorError> : std::true_type {};
