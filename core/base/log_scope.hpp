// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace calibrd {

/// What the lines of a log that a thread writes now belong to; empty: nothing.
struct LogMarks {
  std::string_view request_id;
  std::string_view job_id;
};

/// Those of the calling thread.
inline LogMarks& log_marks() {
  thread_local LogMarks marks;
  return marks;
}

/// Marks what the calling thread logs as long as it lives. The texts must outlive it; it must not live across
/// a co_await, which may go on on another thread.
class LogScope {
 public:
  explicit LogScope(const LogMarks& marks) : before_(log_marks()) { log_marks() = marks; }
  ~LogScope() { log_marks() = before_; }
  LogScope(const LogScope&) = delete;
  LogScope& operator=(const LogScope&) = delete;

 private:
  const LogMarks before_;
};

}  // namespace calibrd
