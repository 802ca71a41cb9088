// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/xml_tags.hpp"

#include <algorithm>

namespace calibrd {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

/// Drops the text up to the next `mark` and the mark itself; all of it when there is none. Returns what was
/// before the mark.
std::string_view take_until(std::string_view& text, std::string_view mark) {
  const auto before = text.substr(0, text.find(mark));
  text.remove_prefix(std::min(text.size(), before.size() + mark.size()));
  return before;
}

/// Drops a tag's inside, quotes and all, up to its `>`. Returns it.
std::string_view take_inside(std::string_view& text) {
  const std::string_view begin = text;
  while (!text.empty() && text.front() != '>') {
    const char c = text.front();
    text.remove_prefix(1);
    if (c == '"' || c == '\'') take_until(text, std::string_view(&c, 1));
  }
  const auto inside = begin.substr(0, begin.size() - text.size());
  text.remove_prefix(std::min<std::size_t>(text.size(), 1));
  return inside;
}

/// What begins with `<` and is no element: passed over.
bool skip_other(std::string_view& xml) {
  if (xml.starts_with("<!--")) return take_until(xml, "-->"), true;
  if (xml.starts_with("<![CDATA[")) return take_until(xml, "]]>"), true;
  if (xml.starts_with("<?") || xml.starts_with("<!")) return take_until(xml, ">"), true;
  return false;
}

}  // namespace

bool next_tag(std::string_view& xml, XmlTag& tag) {
  for (auto open = xml.find('<'); open != std::string_view::npos; open = xml.find('<')) {
    xml.remove_prefix(open);
    if (skip_other(xml)) continue;
    xml.remove_prefix(1);
    auto inside = take_inside(xml);
    tag.opens = !inside.starts_with('/');
    tag.closes = !tag.opens || inside.ends_with('/');
    if (!tag.opens) inside.remove_prefix(1);
    if (tag.opens && tag.closes) inside.remove_suffix(1);
    tag.name = inside.substr(0, inside.find_first_of(kBlank));
    tag.attributes = inside.substr(tag.name.size());
    return true;
  }
  return false;
}

std::string_view attribute(const XmlTag& tag, std::string_view name) {
  auto rest = tag.attributes;
  while (!rest.empty()) {
    auto key = take_until(rest, "=");
    key.remove_prefix(std::min(key.find_first_not_of(kBlank), key.size()));
    key = key.substr(0, key.find_first_of(kBlank));
    const auto quote = rest.find_first_of("\"'");
    if (quote == std::string_view::npos) break;
    const char mark = rest[quote];
    rest.remove_prefix(quote + 1);
    const auto value = take_until(rest, std::string_view(&mark, 1));
    if (key == name) return value;
  }
  return {};
}

std::size_t xml_depth(std::string_view xml) {
  std::size_t depth = 0, deepest = 0;
  for (XmlTag tag; next_tag(xml, tag);) {
    if (tag.opens) deepest = std::max(deepest, ++depth);
    if (tag.closes) depth -= std::min<std::size_t>(depth, 1);
  }
  return deepest;
}

}  // namespace calibrd
