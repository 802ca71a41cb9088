// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace calibrd::api {

// Figures that grow where things happen: some relaxed atomic additions, no lock, no allocation. Safe to use
// from any thread; a reader may see two figures of slightly different moments.

class Counter {
 public:
  void add(std::uint64_t count = 1) { value_.fetch_add(count, std::memory_order_relaxed); }
  std::uint64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

class Gauge {
 public:
  void set(std::int64_t value) { value_.store(value, std::memory_order_relaxed); }
  void add(std::int64_t change) { value_.fetch_add(change, std::memory_order_relaxed); }
  std::int64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::int64_t> value_{0};
};

/// How many of some durations were at most as long as each bound.
template <std::size_t N>
class Histogram {
 public:
  /// `bounds_s`: upper bounds (s), growing.
  explicit constexpr Histogram(const std::array<double, N>& bounds_s) : bounds_s_(bounds_s) {}

  void add(double seconds) {
    const auto bound = std::lower_bound(bounds_s_.begin(), bounds_s_.end(), seconds);
    counts_[static_cast<std::size_t>(bound - bounds_s_.begin())].add();
    sum_us_.add(static_cast<std::uint64_t>(std::max(0.0, seconds) * 1e6));
  }

  const std::array<double, N>& bounds_s() const { return bounds_s_; }
  /// Of bucket i alone; i == N: longer than the last bound.
  std::uint64_t count(std::size_t i) const { return counts_[i].value(); }
  double sum_s() const { return static_cast<double>(sum_us_.value()) / 1e6; }

 private:
  const std::array<double, N> bounds_s_;
  std::array<Counter, N + 1> counts_;
  Counter sum_us_;
};

}  // namespace calibrd::api
