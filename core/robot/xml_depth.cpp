// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/xml_depth.hpp"

#include <algorithm>

namespace calibrd {
namespace {

/// Drops the text up to the next `mark` and the mark itself; all of it when there is none.
void skip_past(std::string_view& text, std::string_view mark) {
  const auto found = text.find(mark);
  text.remove_prefix(found == std::string_view::npos ? text.size() : found + mark.size());
}

/// Drops a tag that begins here. True when it closes itself: <a b="c"/>.
bool skip_tag(std::string_view& text) {
  while (!text.empty() && text.front() != '>') {
    const char c = text.front();
    if (text.starts_with("/>")) return true;
    text.remove_prefix(1);
    if (c == '"' || c == '\'') skip_past(text, std::string_view(&c, 1));
  }
  return false;
}

}  // namespace

std::size_t xml_depth(std::string_view xml) {
  std::size_t depth = 0, deepest = 0;
  for (auto open = xml.find('<'); open != std::string_view::npos; open = xml.find('<')) {
    xml.remove_prefix(open);
    if (xml.starts_with("<!--")) {
      skip_past(xml, "-->");
    } else if (xml.starts_with("<![CDATA[")) {
      skip_past(xml, "]]>");
    } else if (xml.starts_with("<?") || xml.starts_with("<!")) {
      skip_past(xml, ">");
    } else if (xml.starts_with("</")) {
      skip_past(xml, ">");
      depth -= std::min<std::size_t>(depth, 1);
    } else {
      deepest = std::max(deepest, depth + 1);
      if (!skip_tag(xml)) ++depth;
    }
  }
  return deepest;
}

}  // namespace calibrd
