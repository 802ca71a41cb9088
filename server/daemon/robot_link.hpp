// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "core/base/heartbeat.hpp"
#include "drivers/robot/state_client.hpp"

namespace calibrd {

/// A StateClient with the thread it runs on.
class RobotLink {
 public:
  /// Opens nothing yet. Errors: RobotLinkError, detail names the key.
  static Result<std::unique_ptr<RobotLink>> create(const StateClientSettings& settings,
                                                   RobotLinkEvents events);
  ~RobotLink();  ///< stops

  void start();
  /// Closes the connection and ends the thread; no event after it returns.
  void stop();
  /// Safe to call from any thread.
  RobotLinkHealth health() const;
  /// Of its thread.
  const Heartbeat& heartbeat() const;

 private:
  struct Impl;
  explicit RobotLink(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace calibrd
