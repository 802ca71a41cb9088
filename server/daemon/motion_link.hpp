// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "core/base/result.hpp"
#include "core/robot/joint_mapping.hpp"
#include "core/robot/robot_model.hpp"
#include "drivers/robot/motion/motion_client.hpp"
#include "server/config/config.hpp"

namespace calibrd {

/// A MotionClient with the thread it runs on. It exists only where motion.enabled is set.
class MotionLink {
 public:
  explicit MotionLink(const MotionClientSettings& settings);
  ~MotionLink();  ///< stops

  RobotMover& mover() { return *client_; }

  /// The state link's events, told to the mover too.
  RobotLinkEvents heard(RobotLinkEvents events);

  /// Stops a motion under way, waits a moment for the robot's controller to confirm, and closes.
  void stop();

 private:
  struct Thread;
  std::unique_ptr<Thread> thread_;
  std::shared_ptr<MotionClient> client_;
};

/// The configured routes fit the model, and the robot can be commanded through this mapping. The error names
/// the key or route at fault.
Status check_motion(const Config& config, const RobotModel& model, const JointMapping& mapping);

}  // namespace calibrd
