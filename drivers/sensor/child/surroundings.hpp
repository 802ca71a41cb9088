// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace calibrd {

/// What a person needs to see when no sensor is found: the drivers OpenNI2 tried, and where; the USB devices
/// present and those this user may not open.
std::string describe_surroundings();

}  // namespace calibrd
