// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/value.hpp>
#include <string>

namespace calibrd::api {

/// JSON for people and programs: indented by two, lists of numbers on one line, shortest numbers that read
/// back the same (0.1, not 1E-1). Infinities and NaN, which JSON does not have, become null.
std::string json_text(const boost::json::value& value);

/// The same on one line, without the end of line.
std::string json_line(const boost::json::value& value);

}  // namespace calibrd::api
