// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <random>
#include <string>

namespace calibrd {

/// An id that sorts by time and does not repeat: "20260102T030405-1f2e3d" (UTC).
std::string dated_id(std::chrono::system_clock::time_point time, std::mt19937& random);

}  // namespace calibrd
