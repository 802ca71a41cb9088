// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace calibrd {

/// Prints every device OpenNI2 sees with the modes of its cameras, and what was looked for. Returns the exit
/// status: 0 when there is a device, 3 when there is none, 2 when OpenNI2 does not start.
int list_devices();

}  // namespace calibrd
