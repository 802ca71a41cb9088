// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string_view>

namespace calibrd {

// Looks at XML before it is given to parsers that call themselves for each level (TinyXML, assimp's Collada)
// and run out of stack, or follow references for ever.

struct XmlTag {
  std::string_view name;
  std::string_view attributes;  ///< as written
  bool opens = false;           ///< <a> and <a/>
  bool closes = false;          ///< </a> and <a/>
};

/// Takes the next tag from the front of the text; comments, declarations and CDATA are passed over. False:
/// there is none.
bool next_tag(std::string_view& xml, XmlTag& tag);

/// The value of an attribute as written, entities and all; empty without it.
std::string_view attribute(const XmlTag& tag, std::string_view name);

/// How deep the elements lie in each other; of a broken text, at least as deep as a parser would follow it.
std::size_t xml_depth(std::string_view xml);

}  // namespace calibrd
