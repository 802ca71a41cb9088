// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "drivers/robot/robot_link_error.hpp"
#include "drivers/robot/state_client.hpp"
#include "tests/drivers/robot/state_peer.hpp"
#include "tests/drivers/robot/vectors.hpp"

namespace calibrd {

/// One cycle of joints and status as a live server sent it, big endian.
inline const std::vector<std::byte>& cycle() {
  static const std::vector<std::byte> bytes = simple_message::live_first_cycle("bswap/feedback");
  return bytes;
}

/// A client with short times on a thread of its own, and the controller it talks to.
class StateClientTest : public testing::Test {
 protected:
  using State = RobotLinkHealth::State;
  StateClientTest() {
    settings_.host = "127.0.0.1";
    settings_.port = peer_.port();
    settings_.joint_count = 7;
    settings_.link.stale_after = std::chrono::milliseconds(100);
    settings_.link.reconnect_after = std::chrono::milliseconds(300);
    settings_.link.connect_timeout = std::chrono::milliseconds(300);
    settings_.link.backoff_first = std::chrono::milliseconds(2);
    settings_.link.backoff_cap = std::chrono::milliseconds(10);
    settings_.link.eviction_within = std::chrono::milliseconds(0);
  }
  ~StateClientTest() override {
    client_.reset();
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }
  void start() {
    auto created = StateClient::create(context_.get_executor(), settings_, recorder_.events());
    ASSERT_TRUE(created) << created.error().message();
    client_.emplace(std::move(*created));
    client_->start();
    thread_ = std::thread([this] {
      const auto work = boost::asio::make_work_guard(context_);
      context_.run();
    });
  }
  /// stop() returns within 100 ms and nothing is told afterwards.
  void expect_prompt_stop() {
    const auto begin = Clock::now();
    client_->stop();
    EXPECT_LT(Clock::now() - begin, std::chrono::milliseconds(100));
    const std::size_t told = recorder_.event_count();
    client_->stop();
    EXPECT_FALSE(peer_.somebody_connects_within(std::chrono::milliseconds(50)));
    EXPECT_EQ(recorder_.event_count(), told);
  }
  bool wait_for_reason(RobotLinkError error) {
    const std::string reason = make_error_code(error).message();
    return recorder_.wait_for_report(
        [&](const RobotLinkHealth& told) { return told.reason.ends_with(reason); });
  }

  StatePeer peer_;
  StateClientSettings settings_;
  LinkRecorder recorder_;
  boost::asio::io_context context_;
  std::optional<StateClient> client_;
  std::thread thread_;
};

}  // namespace calibrd
