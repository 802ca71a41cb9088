// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What the store holds: the result of a calibration, and a background. Input: which of them, then the text.
#include "api/json/calibration_result_json.hpp"
#include "server/storage/background_text.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace calibrd;

void read_result(const std::string& text) {
  const auto result = api::parse_calibration_result(text);
  if (!result) return fuzz::require(!result.error().message().empty(), "an error says something");
  const auto printed = api::calibration_result_json(*result);
  const auto again = api::parse_calibration_result(printed);
  if (!again) std::fprintf(stderr, "%s\n%s\n", again.error().message().c_str(), printed.c_str());
  fuzz::require(again.has_value(), "what is stored can be read");
  fuzz::require(again->verdict == result->verdict && again->views == result->views, "and says the same");
}

void read_background(const std::string& text) {
  const auto depth_m = parse_background(text);
  if (!depth_m) return;
  const auto again = parse_background(background_text(*depth_m));
  fuzz::require(again && *again == *depth_m, "a stored background stays as it is");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const bool is_result = input.byte() % 2 == 0;
  const std::string text(input.text());
  is_result ? read_result(text) : read_background(text);
  return 0;
}
