// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "server/config/setting.hpp"

namespace calibrd {

/// The keys of [motion] and [motion.routes.NAME].
void declare_motion(std::vector<Setting>& table);

}  // namespace calibrd
