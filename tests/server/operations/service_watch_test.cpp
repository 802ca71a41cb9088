// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/service_watch.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "server/operations/pulse.hpp"
#include "tests/server/operations/notify_peer.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

class ServiceWatchTest : public ::testing::Test {
 protected:
  /// A watchdog of 200 ms, pinged every 50 ms.
  void start(ServiceView view) {
    ServiceView all = std::move(view);
    if (!all.status) all.status = [] { return std::string("well"); };
    if (!all.stalled)
      all.stalled = [this](auto) {
        return is_stalled_ ? std::vector<std::string>{"http"} : std::vector<std::string>();
      };
    if (!all.on_stall) all.on_stall = [this](const auto& names) { told_ = static_cast<int>(names.size()); };
    watch_ = std::make_unique<ServiceWatch>(&*socket_, 200ms, std::move(all));
  }

  const std::string address_ = "@calibrd-watch-" + std::to_string(getpid());
  const NotifyPeer manager_{address_};
  const std::optional<NotifySocket> socket_ = NotifySocket::open(address_);
  std::atomic<bool> is_stalled_{false};
  std::atomic<int> told_{-1};
  std::unique_ptr<ServiceWatch> watch_;
};

TEST_F(ServiceWatchTest, PingsAndTellsTheStatusOnce) {
  start({});
  EXPECT_EQ(manager_.receive(), "WATCHDOG=1");
  EXPECT_EQ(manager_.receive(), "STATUS=well");
  EXPECT_EQ(manager_.receive(), "WATCHDOG=1");
  EXPECT_EQ(manager_.receive(), "WATCHDOG=1");
}

TEST_F(ServiceWatchTest, DoesNotPingWhileAThreadStalls) {
  is_stalled_ = true;
  start({});
  EXPECT_EQ(manager_.receive(600), "");
  EXPECT_EQ(told_, 1);
  is_stalled_ = false;
  EXPECT_EQ(manager_.receive(), "WATCHDOG=1");
}

TEST_F(ServiceWatchTest, TellsEveryChangeOfTheStatus) {
  std::atomic<int> looks{0};
  ServiceView view;
  view.status = [&] { return std::string(looks++ < 3 ? "before" : "after"); };
  start(std::move(view));
  EXPECT_EQ(manager_.receive_beginning("STATUS="), "STATUS=before");
  EXPECT_EQ(manager_.receive_beginning("STATUS="), "STATUS=after");
  watch_.reset();
}

TEST(Pulse, NamesThreadsThatNoLongerBeat) {
  Heartbeat beating, silent, not_begun;
  Pulse pulse;
  pulse.add("beating", beating);
  pulse.add("silent", silent);
  pulse.add("not begun", not_begun);
  silent.beat();
  const auto begin = Heartbeat::Time::now();
  while (Heartbeat::Time::now() - begin < 20ms) beating.beat();
  beating.beat();
  EXPECT_EQ(pulse.stalled(20ms), std::vector<std::string>{"silent"});
  EXPECT_TRUE(pulse.stalled().empty());
}

}  // namespace
}  // namespace calibrd
