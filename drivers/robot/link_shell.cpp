// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/link_shell.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <exception>
#include <new>
#include <thread>
#include <utility>
#include <variant>

#include "drivers/robot/dial.hpp"
#include "drivers/robot/tcp_socket.hpp"

namespace calibrd {

namespace asio = boost::asio;

LinkShell::LinkShell(const asio::any_io_executor& executor, const std::string& host, std::uint16_t port,
                     LinkMachine machine, RobotLinkEvents events)
    : socket_(executor),
      timer_(executor),
      lookup_(executor, host, port),
      machine_(std::move(machine)),
      events_(std::move(events)) {}

void LinkShell::start() {
  asio::post(socket_.get_executor(), [self = shared_from_this()] {
    const std::lock_guard lock(self->mutex_);
    self->carefully([&] { self->obey(self->machine_.start(Clock::now())); });
  });
}

void LinkShell::stop() {
  const std::lock_guard lock(mutex_);
  obey(machine_.stop());
  stopped_ = true;  // completions still under way find it set and do nothing
  timer_.cancel();
}

RobotLinkHealth LinkShell::health() const {
  const std::lock_guard lock(health_mutex_);
  return health_;
}

void LinkShell::obey(const LinkSteps& steps) {
  {
    const std::lock_guard lock(health_mutex_);
    health_ = machine_.health();
  }
  for (const LinkStep& step : steps) {
    if (stopped_) return;
    std::visit([this](const auto& chosen) { carry_out(chosen); }, step);
  }
}

/// Wraps a completion handler: locks, keeps this alive, and drops completions of an earlier connection.
template <class Handler>
auto LinkShell::for_this_connection(Handler handler) {
  return [self = shared_from_this(), connection = connection_,
          handler = std::move(handler)](auto&&... results) mutable {
    const std::lock_guard lock(self->mutex_);
    if (!self->stopped_ && connection == self->connection_)
      self->carefully([&] { handler(std::forward<decltype(results)>(results)...); });
  };
}

/// Completion handlers must not throw: the executor's thread would end, and the robot with it.
template <class Work>
void LinkShell::carefully(Work work) {
  try {
    work();
  } catch (const std::exception& failure) {
    start_over(failure.what());
  }
}

void LinkShell::start_over(const char* what) {
  constexpr int kAttempts = 20;
  constexpr std::chrono::milliseconds kPause(10);  // stop() waits as long as all of them at most
  for (int attempt = 1;; ++attempt) {
    try {
      return obey(machine_.on_trouble(what, Clock::now()));
    } catch (const std::bad_alloc&) {
      if (attempt == kAttempts)
        throw;  // nothing can be done here any more: whoever watches starts calibrd anew
    }
    std::this_thread::sleep_for(kPause);
  }
}

void LinkShell::carry_out(link_step::Connect) {
  ++connection_;
  const auto guard = [this](auto handler) { return for_this_connection(std::move(handler)); };
  dial(lookup_, socket_, guard, [this](const std::error_code& failed) {
    if (failed) return obey(machine_.on_connect_failed(failed, Clock::now()));
    drained_at_ = Clock::now();
    wait_for_bytes();
    obey(machine_.on_connected(drained_at_));
  });
}

void LinkShell::carry_out(link_step::Close) {
  ++connection_;
  lookup_.cancel();
  outbox_.clear();
  leaving_.reset();
  ErrorCode ignored;
  socket_.close(ignored);
}

void LinkShell::wait_for_bytes() {
  socket_.async_wait(Tcp::socket::wait_read, for_this_connection([this](ErrorCode failed) {
                       if (failed) return obey(machine_.on_closed(failed, Clock::now()));
                       read_what_is_there();
                     }));
}

void LinkShell::read_what_is_there() {
  // A flood must not keep the executor from its other work.
  constexpr int kReadsPerTurn = 16;
  const std::uint64_t connection = connection_;
  for (int i = 0; i < kReadsPerTurn; ++i) {
    const bool more = read_once();
    if (stopped_ || connection != connection_) return;
    if (!more) break;
  }
  wait_for_bytes();
}

/// True when more bytes are waiting.
bool LinkShell::read_once() {
  const StampedRead read = read_stamped(socket_, inbox_);
  const Clock::time_point now = Clock::now();
  if (read.error == std::errc::operation_would_block) {
    drained_at_ = now;
    return false;
  }
  if (read.error || read.size == 0) {
    obey(machine_.on_closed(read.error, now));
    return false;
  }
  // The kernel's stamp is of the wall clock; when that is set, the order of things still holds.
  last_stamp_ = std::clamp(read.stamp, std::min(std::max(last_stamp_, drained_at_), now), now);
  ErrorCode failed;
  const bool more = socket_.available(failed) > 0 && !failed;
  if (!more) drained_at_ = now;
  obey(machine_.on_received({std::span(inbox_).first(read.size), last_stamp_, more}, now));
  return more;
}

void LinkShell::carry_out(const link_step::Send& send) {
  outbox_.insert(outbox_.end(), send.bytes.begin(), send.bytes.end());
  write_outbox();
}

void LinkShell::write_outbox() {
  if (leaving_ || outbox_.empty()) return;
  leaving_ = std::make_shared<std::vector<std::byte>>(std::exchange(outbox_, {}));
  // The handler shares the bytes: they must live until the operation has ended, even when this connection is
  // closed.
  auto written = for_this_connection([this, bytes = leaving_](ErrorCode failed, std::size_t) {
    leaving_.reset();
    if (!failed) write_outbox();  // a failure shows on the reading side
  });
  asio::async_write(socket_, asio::buffer(*leaving_), std::move(written));
}

void LinkShell::carry_out(const link_step::ArmTimer& timer) {
  timer_.expires_at(timer.at);
  timer_.async_wait([self = shared_from_this(), round = ++timer_round_](ErrorCode) {
    const std::lock_guard lock(self->mutex_);
    if (self->stopped_ || round != self->timer_round_) return;
    self->carefully([&] { self->obey(self->machine_.on_tick(Clock::now())); });
  });
}

void LinkShell::carry_out(const link_step::DeliverJoints& delivery) {
  if (events_.on_joints) events_.on_joints(delivery.joints);
}

void LinkShell::carry_out(const link_step::DeliverStatus& delivery) {
  if (events_.on_status) events_.on_status(delivery.status);
}

void LinkShell::carry_out(const link_step::ReportHealth& report) {
  if (events_.on_health) events_.on_health(report.health);
}

}  // namespace calibrd
