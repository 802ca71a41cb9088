// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string_view>

namespace calibrd {

/// How deep the elements of an XML text lie in each other; of a broken one, at least as deep as a parser
/// would follow it. Asked before parsers that call themselves for each level (TinyXML, assimp's Collada) and
/// would run out of stack.
std::size_t xml_depth(std::string_view xml);

}  // namespace calibrd
