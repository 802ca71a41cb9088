// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/robot/joint_source.hpp"

namespace calibrd {

/// What a codec found in one piece of the stream.
struct CodecOutput {
  /// The newest joints in the piece. Older ones of the same piece are counted, not kept: nobody knows when
  /// they arrived. `sequence` is left to the link.
  std::optional<ControllerJoints> joints;
  std::optional<ControllerStatus> status;  ///< the newest
  std::uint64_t joint_messages = 0;        ///< usable joint messages in the piece
  /// Well-formed messages that show the peer at work. What it may go on saying while it does not work (texts
  /// beside a handshake that never ends) is not counted: the link must be able to call it silent.
  std::uint64_t messages = 0;
  std::uint64_t rejected_values = 0;
  std::uint64_t other_group = 0;
  std::uint64_t skipped = 0;            ///< messages of other kinds
  std::optional<Error> joints_problem;  ///< why the last unusable joint message was not taken
  std::optional<Error> broken;          ///< the stream cannot be read on: close the connection
  std::vector<std::byte> reply;         ///< to be sent now
};

/// A controller's state protocol without I/O: bytes of one connection after the other in, joints and status
/// out.
class StateCodec {
 public:
  virtual ~StateCodec() = default;

  /// Begins a new connection and forgets the last one. Returns what must be sent first; empty where the peer
  /// talks first.
  virtual std::vector<std::byte> begin() = 0;

  /// Reads the next bytes of the connection, in pieces of any size. `received`: when they arrived. A message
  /// is stamped with the arrival of its first byte, so its age is never understated.
  virtual CodecOutput decode(std::span<const std::byte> bytes, Clock::time_point received) = 0;
};

}  // namespace calibrd
