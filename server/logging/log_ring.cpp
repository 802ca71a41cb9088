// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/logging/log_ring.hpp"

namespace calibrd {

std::string LogRing::text() {
  const std::lock_guard lock(mutex_);
  std::string all;
  all.reserve(bytes_);
  for (const auto& line : lines_) all += line;
  return all;
}

void LogRing::sink_it_(const spdlog::details::log_msg& message) {
  spdlog::memory_buf_t line;
  formatter_->format(message, line);
  lines_.emplace_back(line.data(), line.size());
  bytes_ += line.size();
  while (lines_.size() > kMostLines || bytes_ > kMostBytes) {
    bytes_ -= lines_.front().size();
    lines_.pop_front();
  }
}

}  // namespace calibrd
