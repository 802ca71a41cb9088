// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/sim/controller/messages.hpp"
#include "drivers/sim/world/controller_settings.hpp"

namespace calibrd::sim {

/// What a Universal Robots controller knows at one moment.
struct RtdeState {
  double timestamp_s = 0;  ///< since its start
  std::array<double, 6> positions_rad{}, velocities_rad_s{};
  bool arm_has_power = true;
  bool emergency_stop = false;
};

/// One client of the simulated RTDE server, without I/O. The simulator's own reading of the protocol: it
/// shares nothing with the client's codec.
class RtdeSession {
 public:
  /// The answer to what the client sends, in pieces of any size; nothing when the client must be thrown out.
  std::optional<Bytes> take(std::span<const std::uint8_t> bytes, const ControllerSettings& settings);

  /// The next data package; empty while the client has not started (or has paused) the data.
  Bytes data(const RtdeState& state, const ControllerSettings& settings);

  /// How often the client wants data.
  double frequency_hz() const { return frequency_hz_; }

 private:
  std::optional<Bytes> answer(std::uint8_t type, std::span<const std::uint8_t> payload,
                              const ControllerSettings& settings);
  Bytes set_up_outputs(std::span<const std::uint8_t> payload, const ControllerSettings& settings);
  Bytes text(const std::string& what) const;

  Bytes pending_;  // less than one package
  int protocol_ = 1;
  double frequency_hz_ = 125;
  std::vector<std::string> recipe_;  // empty until one is set up
  bool streaming_ = false;
  std::uint64_t sent_ = 0;
};

}  // namespace calibrd::sim
