// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string_view>

/// What libFuzzer, or replay_main.cpp, calls with one input after the other.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace calibrd::fuzz {

/// What must hold for every input. Aborts, so that a fuzzer takes a broken promise for a crash.
inline void require(bool holds, std::string_view promise) {
  if (holds) return;
  std::fprintf(stderr, "broken: %.*s\n", static_cast<int>(promise.size()), promise.data());
  std::abort();
}

/// Takes an input apart, front to back.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(reinterpret_cast<const char*>(data), size) {}

  /// 0 when nothing is left.
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const auto first = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return first;
  }
  /// What stands before the next `mark`, which is dropped; all that is left when there is none.
  std::string_view until(std::string_view mark) {
    const auto part = rest_.substr(0, rest_.find(mark));
    rest_.remove_prefix(part.size() == rest_.size() ? part.size() : part.size() + mark.size());
    return part;
  }
  bool empty() const { return rest_.empty(); }
  std::string_view text() const { return rest_; }
  std::span<const std::byte> bytes() const { return std::as_bytes(std::span(rest_)); }

 private:
  std::string_view rest_;
};

}  // namespace calibrd::fuzz
