// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>

#include "core/geometry/pose.hpp"
#include "core/sensing/images.hpp"

namespace calibrd::api {

// Values as headers and comments of files carry them.
/// Shortest text that reads back as the same number.
std::string number_text(double value);
/// With a blank between.
std::string numbers_text(std::span<const double> values);
/// 16 numbers, row-major.
std::string pose_text(const Pose& pose);
/// Nanoseconds of the daemon's monotonic clock.
std::int64_t stamp_ns(Clock::time_point time);

}  // namespace calibrd::api
