// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace calibrd::sim {

/// How the simulated controller behaves. The defaults are those of an FS100 with MotoROS.
struct ControllerSettings {
  enum class Mode : std::int32_t {
    normal,
    frozen,       ///< goes on sending, but joints as they were when it froze
    status_only,  ///< position read fails: STATUS alone goes on
    silent,       ///< connections stand, nothing comes
    refuse,       ///< the port is closed and all clients are gone
  };
  enum class Protocol : std::int32_t {
    motoros,         ///< JOINT_FEEDBACK (and _EX with several groups), STATUS
    joint_position,  ///< JOINT_POSITION, STATUS: as FANUC and ABB servers send
  };
  Mode mode = Mode::normal;
  Protocol protocol = Protocol::motoros;
  std::int32_t big_endian = 1;
  std::int32_t send_velocity = 1;
  std::int32_t groups = 1;  ///< 1 to 4; the second is the other robot, the rest stand at 0
  double rate_hz = 40;
  double latency_s = 0.010;  ///< age of the joints when they are sent
  // What STATUS says, and what the motion port obeys only then.
  std::int32_t drives_powered = 1;
  std::int32_t e_stopped = 0;
  std::int32_t in_error = 0;
  std::int32_t automatic = 1;  ///< the pendant: 1 PLAY, 0 teach
  std::int32_t motion_possible =
      1;  ///< the ROS job runs; it does not while the robot has a program of its own
};

}  // namespace calibrd::sim
