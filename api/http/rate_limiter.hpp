// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <unordered_map>

namespace calibrd::api {

/// A bucket for each client: it holds as many requests as may come in a second, each takes one, and it fills
/// again at that rate. One thread.
class RateLimiter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// True: the client may go on. `per_second` 0: always.
  bool take(const std::string& client, int per_second, Time now);

  /// Never more than kMost.
  std::size_t clients() const { return buckets_.size(); }

  static constexpr std::size_t kMost = 4096;

 private:
  struct Bucket {
    double left;
    Time last;
  };
  void make_room(Time now);

  std::unordered_map<std::string, Bucket> buckets_;
};

}  // namespace calibrd::api
