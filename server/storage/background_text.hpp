// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace calibrd {

/// Depths (m) as text: four hexadecimal digits each, tenths of a millimetre; 0000 = nothing known, as is what
/// lies beyond 6.5535 m.
std::string background_text(const std::vector<float>& depth_m);

/// Nothing when the text is no such thing.
std::optional<std::vector<float>> parse_background(const std::string& text);

}  // namespace calibrd
