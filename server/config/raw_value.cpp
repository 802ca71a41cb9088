// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/raw_value.hpp"

#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "server/config/config_error.hpp"
#include "server/config/stray_character.hpp"

namespace calibrd {
namespace {

struct LocatedEntry {
  RawEntry entry;
  toml::source_position at;
};

RawValue raw_value_of(const toml::node& node, const std::filesystem::path& folder) {
  RawValue value;
  value.folder = folder;
  value.is_empty_table = node.is_table();
  if (const auto* array = node.as_array()) {
    std::vector<RawValue> elements;
    for (const auto& element : *array) elements.push_back(raw_value_of(element, folder));
    value.data = std::move(elements);
  } else if (const auto* boolean = node.as_boolean()) {
    value.data = boolean->get();
  } else if (const auto* integer = node.as_integer()) {
    value.data = integer->get();
  } else if (const auto* real = node.as_floating_point()) {
    value.data = real->get();
  } else if (const auto* string = node.as_string()) {
    value.data = string->get();
  } else {
    std::ostringstream written;  // dates and tables in arrays: no setting takes them
    written << toml::node_view<const toml::node>(node);
    value.data = written.str();
  }
  return value;
}

class Flattener {
 public:
  explicit Flattener(const std::filesystem::path& file)
      : name_(file.filename().string()), folder_(std::filesystem::absolute(file).parent_path()) {}

  void walk(const toml::table& table, std::vector<std::string>& path) {
    for (const auto& [key, node] : table) {
      path.emplace_back(key.str());
      if (const auto* inner = node.as_table(); inner && !inner->empty()) {
        walk(*inner, path);
      } else {
        const auto at = key.source().begin;
        entries_.push_back({{path, leaf(node), name_ + ":" + std::to_string(at.line)}, at});
      }
      path.pop_back();
    }
  }

  std::vector<RawEntry> in_file_order() {
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const auto& a, const auto& b) { return a.at.line < b.at.line; });
    std::vector<RawEntry> ordered;
    for (auto& located : entries_) ordered.push_back(std::move(located.entry));
    return ordered;
  }

 private:
  RawValue leaf(const toml::node& node) const { return raw_value_of(node, folder_); }

  std::string name_;
  std::filesystem::path folder_;
  std::vector<LocatedEntry> entries_;
};

}  // namespace

Result<std::vector<RawEntry>> read_toml_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(stream), {}};
  if (!std::filesystem::is_regular_file(file) || !stream.is_open() || stream.bad())
    return Error{ConfigError::file_unreadable, file.string()};
  const auto file_and_line = [&](std::size_t line) {
    return file.filename().string() + ":" + std::to_string(line);
  };
  if (const auto line = line_of_stray_character(content))
    return Error{ConfigError::not_toml,
                 file_and_line(*line) + ": a character beyond ASCII outside comments and quotes"};
  const auto parsed = toml::parse(content);
  if (!parsed) {
    const auto& failure = parsed.error();
    return Error{ConfigError::not_toml,
                 file_and_line(failure.source().begin.line) + ": " + std::string(failure.description())};
  }
  Flattener flattener(file);
  std::vector<std::string> path;
  flattener.walk(parsed.table(), path);
  return flattener.in_file_order();
}

RawValue parse_text_value(const std::string& text) {
  RawValue value;
  const auto folder = std::filesystem::current_path();
  const auto parsed = toml::parse(line_of_stray_character(text) ? "" : "value = " + text);
  const toml::node* node = parsed ? parsed.table().get("value") : nullptr;
  if (node != nullptr && !node->is_table() && parsed.table().size() == 1)
    value = raw_value_of(*node, folder);
  else
    value.data = text;
  value.text = text;
  value.folder = folder;
  return value;
}

std::string join_path(const std::vector<std::string>& path) {
  std::string joined;
  for (const auto& part : path) joined += (joined.empty() ? "" : ".") + part;
  return joined;
}

std::vector<std::string> split_path(std::string_view dotted) {
  std::vector<std::string> parts{""};
  for (const char c : dotted)
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

}  // namespace calibrd
