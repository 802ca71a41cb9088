// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Every call of the link to a controller fails once, in turn: it says so, and comes back by itself.
#include <gtest/gtest.h>
#include <netdb.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <cerrno>
#include <thread>

#include "drivers/robot/state_client.hpp"
#include "tests/drivers/faults/call_faults.hpp"
#include "tests/drivers/robot/state_peer.hpp"
#include "tests/drivers/robot/vectors.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

StateClientSettings settings_for(const StatePeer& peer) {
  StateClientSettings settings;
  settings.host = "localhost";  // a name: looked up on a thread of its own
  settings.port = peer.port();
  settings.joint_count = 7;
  settings.link.stale_after = 60ms;
  settings.link.reconnect_after = 150ms;
  settings.link.connect_timeout = 150ms;
  settings.link.backoff_first = 2ms;
  settings.link.backoff_cap = 10ms;
  settings.link.eviction_within = 0ms;
  return settings;
}

/// A link on a thread of its own, whose controller sends joints all the time and closes the connection once.
class LinkAtWork {
 public:
  LinkAtWork()
      : client_(*StateClient::create(context_.get_executor(), settings_for(peer_), recorder_.events())) {}
  ~LinkAtWork() { end(); }
  void begin() {
    client_.start();
    thread_ = std::thread([this] { context_.run(); });
  }
  /// Sends until the client has told of so many joints more.
  bool deliver(std::size_t joints) {
    const auto told = [this] { return count(); };
    const auto wanted = told() + joints;
    const auto deadline = Clock::now() + kPatience;
    while (told() < wanted && Clock::now() < deadline) {
      if (peer_.somebody_connects_within(1ms)) connection_.emplace(peer_.accept());
      if (connection_) connection_->send(simple_message::live_first_cycle("bswap/feedback"));
    }
    return told() >= wanted;
  }
  void hang_up() { connection_.reset(); }
  void end() {
    client_.stop();
    work_.reset();
    context_.stop();
    if (thread_.joinable()) thread_.join();
    connection_.reset();
  }
  std::vector<RobotLinkHealth> reports() const { return recorder_.reports; }  ///< after end()

 private:
  std::size_t count() {
    std::size_t count = 0;
    recorder_.wait_for([&] { return count = recorder_.joints.size(), true; });
    return count;
  }
  StatePeer peer_;
  LinkRecorder recorder_;
  boost::asio::io_context context_{1};
  std::optional<boost::asio::executor_work_guard<boost::asio::io_context::executor_type>> work_{
      boost::asio::make_work_guard(context_)};
  StateClient client_;
  std::optional<PeerConnection> connection_;
  std::thread thread_;
};

struct Fault {
  faults::Call call;
  int error;
  int most = 8;  ///< how many of its calls fail in turn, where a link makes more and more of them
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << name_of(fault.call) << ' ' << fault.error; }

/// False: there are not that many such calls.
bool survives(const Fault& fault, int n) {
  LinkAtWork link;
  faults::fail(fault.call, n, fault.error);
  link.begin();
  EXPECT_TRUE(link.deliver(2));
  link.hang_up();
  EXPECT_TRUE(link.deliver(2)) << "it does not come back";
  const bool has_failed = faults::heal();
  EXPECT_TRUE(link.deliver(2));
  link.end();
  for (const auto& report : link.reports())
    EXPECT_TRUE(report.state == RobotLinkHealth::State::streaming || report.reason.size() > 20U)
        << report.reason;
  return has_failed;
}

class RobotLinkCalls : public ::testing::TestWithParam<Fault> {};

TEST_P(RobotLinkCalls, EachMayFailAndTheJointsComeBack) {
  const faults::Bystander the_test;
  {
    LinkAtWork first;  // what is made once and kept: resolver, locale, log
    first.begin();
    ASSERT_TRUE(first.deliver(1));
  }
  const std::size_t descriptors = open_descriptors();
  int n = 1;
  while (n <= GetParam().most && survives(GetParam(), n)) {
    ASSERT_FALSE(HasFailure()) << "call number " << n;
    ++n;
  }
  EXPECT_FALSE(HasFailure()) << "call number " << n;
  EXPECT_GT(n, 1) << "there was nothing to fail";
  EXPECT_EQ(open_descriptors(), descriptors);
}

using faults::Call;
INSTANTIATE_TEST_SUITE_P(
    One, RobotLinkCalls,
    ::testing::Values(Fault{Call::socket, EMFILE}, Fault{Call::socket, ENOBUFS},
                      Fault{Call::connect, ENETUNREACH}, Fault{Call::connect, EADDRNOTAVAIL},
                      Fault{Call::getsockopt, ENOBUFS}, Fault{Call::setsockopt, ENOMEM, 20},
                      Fault{Call::ioctl, ENOMEM, 12}, Fault{Call::getsockname, ENOBUFS},
                      Fault{Call::getpeername, ENOTCONN}, Fault{Call::epoll_ctl, ENOMEM, 12},
                      Fault{Call::epoll_wait, EINTR, 12}, Fault{Call::recvmsg, ECONNRESET},
                      Fault{Call::recvmsg, EINTR}, Fault{Call::recvmsg, ENOMEM},
                      Fault{Call::getaddrinfo, EAI_AGAIN}, Fault{Call::pthread_create, EAGAIN},
                      Fault{Call::allocation, ENOMEM, 400}),
    [](const auto& info) {
      return std::string(name_of(info.param.call)) + "_" + std::to_string(std::abs(info.param.error));
    });

}  // namespace
}  // namespace calibrd
