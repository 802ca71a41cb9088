// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.hpp"
#include "drivers/robot/motion/motion_error.hpp"
#include "drivers/robot/motion/motion_machine.hpp"

namespace calibrd {

/// What a mover tells of one motion; one call at a time. The functions must not call the mover.
struct MotionEvents {
  std::function<void(const std::string& what)> on_command;  ///< every command sent, port opened and closed
  std::function<void(std::size_t postures)> on_reached;
  std::function<void(const MotionEnd&)> on_end;  ///< once; the last call
};

/// Moves one robot. Safe to call from any thread.
class RobotMover {
 public:
  virtual ~RobotMover() = default;

  /// Why no motion can be started now; nothing: one can. Errors: MotionError.
  virtual std::optional<Error> doubt() const = 0;

  /// Begins; refuses while there is a doubt or another motion is under way. Errors: MotionError.
  virtual Status start(MotionOrder order, MotionEvents events) = 0;

  /// Stops the motion under way at once; does not wait for its end.
  virtual void stop(MotionError why) = 0;
};

}  // namespace calibrd
