// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace calibrd::api {

/// The name of `known` that `wanted` most probably meant (fewest edits, case aside); empty when none is near.
std::string nearest_name(std::string_view wanted, std::span<const std::string> known);

/// "did you mean 'port'?", or "known: address, port" when none is near.
std::string name_hint(std::string_view wanted, std::span<const std::string> known);

}  // namespace calibrd::api
