// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace calibrd::fleet {

/// What may be told under a cell's name.
enum class Voice {
  waiting,    ///< not known yet whether the name is ours alone: that we are there, and no more
  clear,      ///< everything
  contested,  ///< another daemon speaks under it, too: nothing that it says or we say can be trusted
};

/// Finds out whether two daemons speak under one name, as where a computer's disk was copied. A broker lets
/// one connection of a name stand: the two throw each other out, and each finds the other's status when it is
/// back. Does no I/O.
class NameGuard {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// `instance`: of this run of the daemon, like no other.
  explicit NameGuard(std::string instance) : instance_(std::move(instance)) {}

  const std::string& instance() const { return instance_; }
  void connected(Time now);
  /// A status/1 of this cell, as the broker has kept it. True: this is how the name turned out to be
  /// contested.
  bool hear(std::string_view status, Time now);
  Voice voice(Time now) const;

 private:
  const std::string instance_;
  int connections_ = 0;
  Time connected_at_{};
  std::optional<Time> contested_at_;
};

/// 128 random bits as hexadecimal digits.
std::string random_instance();

}  // namespace calibrd::fleet
