// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_client.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <new>
#include <thread>
#include <utility>

#include "drivers/robot/dial.hpp"
#include "drivers/robot/tcp_socket.hpp"

namespace calibrd {

namespace asio = boost::asio;

namespace {

// State and IO ports of MotoROS and of generic simple_message servers.
constexpr std::array kPortsForOtherThings = {50241, 50242, 11002, 11003};

}  // namespace

Status check(const MotionClientSettings& settings) {
  const bool fits = settings.port >= 1 && settings.port <= 65535 && settings.port != settings.state_port &&
                    std::ranges::find(kPortsForOtherThings, settings.port) == kPortsForOtherThings.end();
  if (fits) return Done{};
  return Error{MotionError::port_not_for_motion, "motion.port = " + std::to_string(settings.port)};
}

MotionClient::MotionClient(const asio::any_io_executor& executor, MotionClientSettings settings)
    : settings_(std::move(settings)),
      socket_(executor),
      timer_(executor),
      lookup_(executor, settings_.host, static_cast<std::uint16_t>(settings_.port)),
      watch_(settings_.watch) {}

template <class Told>
void MotionClient::feed(const Told& told) {
  const std::lock_guard lock(mutex_);
  carefully([&] {
    watch_.take(told);
    if (machine_) obey(machine_->on_watch(Clock::now()));
  });
}

void MotionClient::take(const ControllerJoints& joints) { feed(joints); }
void MotionClient::take(const ControllerStatus& status) { feed(status); }
void MotionClient::take(const RobotLinkHealth& health) { feed(health); }

std::optional<Error> MotionClient::doubt() const {
  const std::lock_guard lock(mutex_);
  return watch_.doubt_before_start(Clock::now());
}

bool MotionClient::is_busy() const {
  const std::lock_guard lock(mutex_);
  return machine_.has_value();
}

Status MotionClient::start(MotionOrder order, MotionEvents events) {
  const std::lock_guard lock(mutex_);
  if (is_shut_down_) return Error{MotionError::daemon_ends, {}};
  if (machine_) return Error{MotionError::in_motion, "another motion is under way"};
  const auto now = Clock::now();
  if (auto doubt = watch_.doubt_before_start(now)) return *std::move(doubt);
  machine_.emplace(std::move(order), settings_.motion, watch_);
  events_ = std::move(events);
  carefully([&] { obey(machine_->start(now)); });
  return Done{};
}

void MotionClient::stop(MotionError why) {
  const std::lock_guard lock(mutex_);
  if (machine_) carefully([&] { obey(machine_->stop(why, Clock::now())); });
}

void MotionClient::shut_down() {
  const std::lock_guard lock(mutex_);
  end_now({Error{MotionError::daemon_ends, {}}});
  is_shut_down_ = true;
}

/// Completion handlers must not throw: the executor's thread would end. What the machine decided may be half
/// done by then, so that it is not asked again: closing stops the robot.
template <class Work>
void MotionClient::carefully(Work work) {
  try {
    work();
  } catch (const std::exception&) {
    end_now({Error{MotionError::short_of_resources, {}}});
  }
}

void MotionClient::end_now(const MotionEnd& end) {
  close();
  if (machine_) carry_out(motion_step::Finish{end});
}

void MotionClient::obey(MotionSteps steps) {
  for (const MotionStep& step : steps) {
    if (is_shut_down_) return;
    std::visit([this](const auto& chosen) { carry_out(chosen); }, step);
  }
}

/// Wraps a completion handler: locks, keeps this alive, and drops completions of an earlier connection.
template <class Handler>
auto MotionClient::for_this_connection(Handler handler) {
  return [self = shared_from_this(), connection = connection_,
          handler = std::move(handler)](auto&&... results) mutable {
    const std::lock_guard lock(self->mutex_);
    if (self->machine_ && connection == self->connection_)
      self->carefully([&] { handler(std::forward<decltype(results)>(results)...); });
  };
}

void MotionClient::carry_out(motion_step::Connect) {
  tell("opening the motion port " + settings_.host + ":" + std::to_string(settings_.port));
  ++connection_;
  const auto guard = [this](auto handler) { return for_this_connection(std::move(handler)); };
  dial(lookup_, socket_, guard, [this](const std::error_code& failed) {
    if (failed) return obey(machine_->on_connect_failed(failed, Clock::now()));
    wait_for_bytes();
    obey(machine_->on_connected(Clock::now()));
  });
}

void MotionClient::wait_for_bytes() {
  socket_.async_wait(Tcp::socket::wait_read, for_this_connection([this](ErrorCode failed) {
                       if (failed) return obey(machine_->on_closed(failed, Clock::now()));
                       read_what_is_there();
                     }));
}

void MotionClient::read_what_is_there() {
  const StampedRead read = read_stamped(socket_, inbox_);
  const auto now = Clock::now();
  const std::uint64_t connection = connection_;
  if (read.error != std::errc::operation_would_block) {
    if (read.error || read.size == 0) return obey(machine_->on_closed(read.error, now));
    obey(machine_->on_received(std::span(inbox_).first(read.size), now));
  }
  if (machine_ && connection == connection_) wait_for_bytes();
}

void MotionClient::carry_out(const motion_step::Send& send) {
  outbox_.push_back(std::make_shared<std::vector<std::byte>>(send.bytes));
  if (outbox_.size() == 1) write_next();
  tell(send.what);  // after it: a log that is stuck must not hold up a stop
}

/// One message at a time, so that each leaves in one piece.
void MotionClient::write_next() {
  // The handler shares the bytes: they must live until the operation has ended, even when this connection is
  // closed.
  auto written = for_this_connection([this, bytes = outbox_.front()](ErrorCode failed, std::size_t) {
    outbox_.pop_front();
    if (!failed && !outbox_.empty()) write_next();  // a failure shows on the reading side
  });
  asio::async_write(socket_, asio::buffer(*outbox_.front()), std::move(written));
}

void MotionClient::carry_out(motion_step::ArmTimer timer) {
  timer_.expires_at(timer.at);
  timer_.async_wait([self = shared_from_this(), round = ++timer_round_](ErrorCode) {
    const std::lock_guard lock(self->mutex_);
    if (!self->machine_ || round != self->timer_round_) return;
    self->carefully([&] { self->obey(self->machine_->on_tick(Clock::now())); });
  });
}

void MotionClient::carry_out(motion_step::Reached reached) {
  if (events_.on_reached) events_.on_reached(reached.postures);
}

void MotionClient::carry_out(motion_step::Close) {
  if (socket_.is_open()) tell("closing the motion port");
  close();
}

void MotionClient::close() {
  ++connection_;
  lookup_.cancel();
  outbox_.clear();
  ErrorCode ignored;
  socket_.close(ignored);
}

/// Whoever waits for the end is told, if memory can be had at all: else every later motion would be refused.
void MotionClient::carry_out(const motion_step::Finish& finish) {
  constexpr int kAttempts = 20;
  constexpr std::chrono::milliseconds kPause(10);
  ++timer_round_;
  timer_.cancel();
  machine_.reset();
  const auto events = std::exchange(events_, {});
  for (int attempt = 1; events.on_end; ++attempt) {
    try {
      return events.on_end(finish.end);
    } catch (const std::bad_alloc&) {
      if (attempt == kAttempts) throw;
    }
    std::this_thread::sleep_for(kPause);
  }
}

void MotionClient::tell(const std::string& what) const {
  if (events_.on_command) events_.on_command(what);
}

}  // namespace calibrd
