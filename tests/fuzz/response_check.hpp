// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "api/routes/message.hpp"

namespace calibrd::fuzz {

/// What every answer keeps to: a known status and no failure of our own, headers of one line, JSON that a
/// strict reader takes.
void check_response(const api::Response& response);

}  // namespace calibrd::fuzz
