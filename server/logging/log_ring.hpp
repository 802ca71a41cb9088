// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <spdlog/sinks/base_sink.h>

#include <deque>
#include <mutex>
#include <string>

namespace calibrd {

/// Keeps the newest lines of the log in memory, for a support bundle: at most a thousand, and 256 KiB.
class LogRing : public spdlog::sinks::base_sink<std::mutex> {
 public:
  /// Oldest first, each with its end of line.
  std::string text();

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}

 private:
  static constexpr std::size_t kMostLines = 1000, kMostBytes = 256 * 1024;
  std::deque<std::string> lines_;  // guarded by the sink's mutex_
  std::size_t bytes_ = 0;
};

}  // namespace calibrd
