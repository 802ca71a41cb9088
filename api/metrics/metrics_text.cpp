// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/metrics/metrics_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace calibrd::api {
namespace {

void append_escaped(std::string& line, std::string_view text, bool in_quotes) {
  for (const char c : text) {
    if (c == '\\')
      line += "\\\\";
    else if (c == '\n')
      line += "\\n";
    else if (c == '"' && in_quotes)
      line += "\\\"";
    else
      line += c;
  }
}

std::string text_of(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

}  // namespace

void MetricsText::begin(std::string_view family) {
  const auto* row = find_metric(family);
  if (!row) throw std::logic_error(std::string(family) + ": add it to the metric table");
  family_ = family;
  text_.append("# HELP ").append(family_).append(" ");
  append_escaped(text_, row->help, false);
  text_.append("\n# TYPE ").append(family_).append(" ").append(name_of(row->type)).append("\n");
}

void MetricsText::add(const Labels& labels, double value) { add_sample(family_, labels, value); }

void MetricsText::add_states(const Labels& labels, std::string_view label,
                             std::span<const char* const> states, std::string_view now) {
  Labels all = labels;
  all.emplace_back(label, "");
  for (const char* state : states) {
    all.back().second = state;
    add(all, state == now ? 1 : 0);
  }
}

void MetricsText::add_buckets(Labels labels, std::span<const double> bounds,
                              std::span<const std::uint64_t> counts, double sum) {
  double total = 0;
  const auto plain = labels;
  labels.emplace_back("le", "");
  for (std::size_t i = 0; i < counts.size(); ++i) {
    total += static_cast<double>(counts[i]);
    const auto bound = i < bounds.size() ? text_of(bounds[i]) : "+Inf";
    labels.back().second = bound;
    add_sample(family_ + "_bucket", labels, total);
  }
  add_sample(family_ + "_sum", plain, sum);
  add_sample(family_ + "_count", plain, total);
}

void MetricsText::add_sample(std::string_view name, const Labels& labels, double value) {
  text_ += name;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    text_.append(i == 0 ? "{" : ",").append(labels[i].first).append("=\"");
    append_escaped(text_, labels[i].second, true);
    text_ += '"';
  }
  text_.append(labels.empty() ? " " : "} ").append(text_of(value)).append("\n");
}

}  // namespace calibrd::api
