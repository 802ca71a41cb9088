// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

namespace calibrd::sim {

/// How the simulated controller behaves. The defaults are those of an FS100 with MotoROS.
struct ControllerSettings {
  enum class Mode : std::int32_t {
    normal,
    frozen,       ///< goes on sending, but joints (and clock, where it has one) as they were when it froze
    status_only,  ///< position read fails: STATUS alone goes on; RTDE: the arm has no power
    silent,       ///< connections stand, nothing comes
    refuse,       ///< the port is closed and all clients are gone
  };
  enum class Protocol : std::int32_t {
    motoros,         ///< JOINT_FEEDBACK (and _EX with several groups), STATUS
    joint_position,  ///< JOINT_POSITION, STATUS: as FANUC and ABB servers send
    rtde,            ///< Universal Robots: answers requests, then sends data as often as it was asked to
  };
  Mode mode = Mode::normal;
  Protocol protocol = Protocol::motoros;
  std::int32_t big_endian = 1;
  std::int32_t send_velocity = 1;
  std::int32_t groups = 1;  ///< 1 to 4; the second is the other robot, the rest stand at 0
  double rate_hz = 40;
  double latency_s = 0.010;       ///< age of the joints when they are sent
  std::int32_t status_every = 1;  ///< STATUS in every cycle, or in every so-many-th (FANUC: 11)
  std::int32_t send_bytes = 0;    ///< simple_message leaves in pieces of so many bytes (FANUC: 4); 0: whole
  std::int32_t j3_from_horizontal = 0;  ///< reports joint 3 less joint 2, as FANUC does

  // What STATUS says, and what the motion port obeys only then.
  std::int32_t drives_powered = 1;
  std::int32_t e_stopped = 0;
  std::int32_t in_error = 0;
  std::int32_t automatic = 1;  ///< the pendant: 1 PLAY, 0 teach
  std::int32_t motion_possible =
      1;  ///< the ROS job runs; it does not while the robot has a program of its own

  // RTDE only
  std::int32_t rtde_protocol = 2;  ///< the highest that is accepted; 1: as old controllers
  std::int32_t rtde_texts = 0;     ///< text messages before every reply and now and then between data
  std::string rtde_missing;        ///< a variable that is not there
};

}  // namespace calibrd::sim
