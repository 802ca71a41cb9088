// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "core/base/result.hpp"

namespace calibrd {

/// Makes the whole process that of another user, with all groups of that user, for good, and forbids it and
/// its children to gain rights by any program they start. Call it in the first thread, before others are
/// started. A process that is that user's already is left as it is. Errors: SecurityError::no_such_user,
/// cannot_become.
Status become(const std::string& user);

}  // namespace calibrd
