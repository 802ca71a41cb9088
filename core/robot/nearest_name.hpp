// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace calibrd {

/// The name of `known` that `wanted` most probably meant (fewest edits); empty when none is near.
std::string nearest_name(std::string_view wanted, std::span<const std::string> known);

/// For error details: "did you mean 'joint_s'? known: joint_s, joint_l"; names the known ones only when none
/// is near.
std::string name_hint(std::string_view wanted, std::span<const std::string> known);

}  // namespace calibrd
