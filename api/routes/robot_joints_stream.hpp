// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>

#include "api/routes/message.hpp"
#include "api/service/cell_service.hpp"

namespace calibrd::api {

/// The robot's joints, 30 times a second, as server-sent events without ids: what was missed is not worth
/// having. It goes on while the robot is silent: who listens sees how old the joints are, and that the daemon
/// is there.
class RobotJointsStream : public BodyStream {
 public:
  /// `service` must outlive it.
  explicit RobotJointsStream(const CellService& service) : service_(service) {}

  std::string next() override;
  std::chrono::milliseconds pause() const override { return std::chrono::milliseconds(5); }

 private:
  const CellService& service_;
  std::chrono::steady_clock::time_point due_ = std::chrono::steady_clock::now();
};

}  // namespace calibrd::api
