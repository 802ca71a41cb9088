// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/rate_limiter.hpp"

#include <algorithm>

namespace calibrd::api {

bool RateLimiter::take(const std::string& client, int per_second, Time now) {
  if (per_second <= 0) return true;
  auto found = buckets_.find(client);
  if (found == buckets_.end()) {
    make_room(now);
    found = buckets_.emplace(client, Bucket{static_cast<double>(per_second), now}).first;
  }
  auto& [left, last] = found->second;
  const std::chrono::duration<double> passed = now - last;
  left = std::min(left + passed.count() * per_second, static_cast<double>(per_second));
  last = now;
  if (left < 1) return false;
  left -= 1;
  return true;
}

/// A client that has been silent for a second has a full bucket, as one that was never there.
void RateLimiter::make_room(Time now) {
  if (buckets_.size() < kMost) return;
  std::erase_if(buckets_,
                [&](const auto& entry) { return now - entry.second.last > std::chrono::seconds(1); });
  if (buckets_.size() >= kMost) buckets_.erase(buckets_.begin());
}

}  // namespace calibrd::api
