// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Every call of the link to the motion port, and of the state link beside it, fails once, in turn: the motion
// goes on and can be stopped, or it ends, says so and lets go of the port; and so does the next one.
#include <cerrno>
#include <future>

#include "tests/drivers/faults/call_faults.hpp"
#include "tests/drivers/robot/motion/motion_client_fixture.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using faults::Call;

struct Fault {
  Call call;
  int error;
  int most;  ///< how many of its calls fail in turn
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << name_of(fault.call) << ' ' << fault.error; }

MotionSettings quick() {
  MotionSettings settings;
  settings.limits = {1, 20};
  settings.hold = 1ms;
  settings.watch_period = 5ms;
  settings.connect_timeout = settings.reply_timeout = settings.mode_timeout = 200ms;
  settings.arrive_timeout = 300ms;
  return settings;
}

MotionWatchSettings soon() {
  MotionWatchSettings settings;
  settings.rest = 30ms;
  return settings;
}

class MotionLinkCalls : public MotionClientTest, public testing::WithParamInterface<Fault> {
 protected:
  MotionLinkCalls() : MotionClientTest(quick(), soon()) {
    simulator_.run([] { static thread_local const faults::Bystander its_thread; });
  }

  /// Begins a motion, and stops it once it is well under way. Nothing: it could not begin.
  std::optional<MotionEnd> move() {
    note([&] {
      end_.reset();
      commands_.clear();
    });
    MotionEvents events;
    events.on_command = [this](const std::string& what) { note([&] { commands_.push_back(what); }); };
    events.on_end = [this](const MotionEnd& end) { note([&] { end_ = end; }); };
    const auto here = robot();
    const MotionOrder order{{here.begin(), here.begin() + 7}, {posture(here[0] > 0 ? -1 : 1, 0.2, 0.3)}};
    if (!begins(order, std::move(events))) return std::nullopt;
    wait_for([&] { return end_ || commands_.size() > 6; });
    client_->stop(MotionError::stop_requested);
    wait_for([&] { return end_.has_value(); });
    return end_;
  }
  /// On a thread of its own, where calls fail as well.
  bool begins(const MotionOrder& order, MotionEvents events) {
    auto begun =
        std::async(std::launch::async, [&] { return client_->start(order, std::move(events)).has_value(); });
    try {
      return begun.get();
    } catch (const std::bad_alloc&) {
      return false;
    }
  }
  void make_ready() {
    set([](auto& settings) { settings.motion_possible = 1; });  // a person starts its job again after a stop
    wait_for([&] { return !client_->doubt(); });
  }

  /// False: there are not that many such calls.
  bool survives(int n) {
    make_ready();
    faults::fail(GetParam().call, n, GetParam().error);
    const auto end = move();
    const bool has_failed = faults::heal();
    EXPECT_FALSE(client_->is_busy());
    if (end) {
      EXPECT_GT(end->error->message().size(), 10U);
    }
    wait_for([&] { return !simulator_.run([this] { return motion_.has_client(); }); });
    make_ready();
    const auto next = move();
    EXPECT_TRUE(next && next->error->code == MotionError::stop_requested)
        << (next ? next->error->message() : "it cannot begin");
    return has_failed;
  }
};

TEST_P(MotionLinkCalls, EachMayFailAndTheNextMotionRuns) {
  const faults::Bystander the_test;
  int n = 1;
  while (n <= GetParam().most && survives(n)) {
    ASSERT_FALSE(HasFailure()) << "call number " << n;
    ++n;
  }
  EXPECT_FALSE(HasFailure()) << "call number " << n;
  EXPECT_GT(n, 1) << "there was nothing to fail";
}

INSTANTIATE_TEST_SUITE_P(
    One, MotionLinkCalls,
    testing::Values(Fault{Call::socket, EMFILE, 2}, Fault{Call::connect, ENETUNREACH, 2},
                    Fault{Call::getsockopt, ENOBUFS, 3}, Fault{Call::setsockopt, ENOMEM, 6},
                    Fault{Call::ioctl, ENOMEM, 4}, Fault{Call::epoll_ctl, ENOMEM, 12},
                    Fault{Call::recvmsg, ECONNRESET, 10}, Fault{Call::recvmsg, ENOMEM, 10},
                    Fault{Call::send, EPIPE, 10}, Fault{Call::allocation, ENOMEM, 300}),
    [](const auto& info) {
      return std::string(name_of(info.param.call)) + "_" + std::to_string(info.param.error);
    });

}  // namespace
}  // namespace calibrd
