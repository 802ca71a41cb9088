// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/robot/motion/robot_mover.hpp"
#include "drivers/robot/name_lookup.hpp"

namespace calibrd {

struct MotionClientSettings {
  std::string host;
  int port = 50240;
  int state_port = 50241;  ///< of the same controller; never used for motion
  MotionSettings motion;
  MotionWatchSettings watch;
};

/// The port is not one of those that are known to be for something else. Error:
/// MotionError::port_not_for_motion.
Status check(const MotionClientSettings& settings);

/// Carries out what MotionMachines decide: one TCP connection while a motion runs, none otherwise. It must be
/// fed with all that the state link tells. Whatever fails, the motion ends and its end is told. Thread-safe.
/// Must be owned by a shared_ptr; shut_down() before the executor's context ends.
class MotionClient : public RobotMover, public std::enable_shared_from_this<MotionClient> {
 public:
  MotionClient(const boost::asio::any_io_executor& executor, MotionClientSettings settings);

  void take(const ControllerJoints& joints);
  void take(const ControllerStatus& status);
  void take(const RobotLinkHealth& health);

  std::optional<Error> doubt() const override;
  Status start(MotionOrder order, MotionEvents events) override;
  void stop(MotionError why) override;

  /// A motion is under way.
  bool is_busy() const;

  /// Closes at once; nothing starts afterwards. Closing stops the robot too, but stop() first is kinder.
  void shut_down();

 private:
  using Tcp = boost::asio::ip::tcp;
  using ErrorCode = boost::system::error_code;

  template <class Told>
  void feed(const Told& told);

  template <class Work>
  void carefully(Work work);
  void end_now(const MotionEnd& end);
  void close();

  void obey(MotionSteps steps);
  void carry_out(motion_step::Connect);
  void carry_out(const motion_step::Send& send);
  void carry_out(motion_step::ArmTimer timer);
  void carry_out(motion_step::Reached reached);
  void carry_out(motion_step::Close);
  void carry_out(const motion_step::Finish& finish);

  template <class Handler>
  auto for_this_connection(Handler handler);
  void wait_for_bytes();
  void read_what_is_there();
  void write_next();
  void tell(const std::string& what) const;

  const MotionClientSettings settings_;

  // Guards what follows and serialises the events. Recursive because a step may lead to another.
  mutable std::recursive_mutex mutex_;
  Tcp::socket socket_;
  boost::asio::steady_timer timer_;
  NameLookup lookup_;
  MotionWatch watch_;
  std::optional<MotionMachine> machine_;
  MotionEvents events_;
  std::uint64_t connection_ = 0;  // counts attempts and closes: completions of an earlier one are ignored
  std::uint64_t timer_round_ = 0;
  std::array<std::byte, 4096> inbox_{};
  std::deque<std::shared_ptr<std::vector<std::byte>>> outbox_;  // the front is being sent
  bool is_shut_down_ = false;
};

}  // namespace calibrd
