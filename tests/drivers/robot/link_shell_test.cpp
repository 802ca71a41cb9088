// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/link_shell.hpp"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <cstring>
#include <thread>

#include "drivers/robot/simple_message_codec.hpp"
#include "tests/drivers/robot/state_peer.hpp"
#include "tests/drivers/robot/vectors.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;

Bytes bytes_of(const char* text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text);
  return {begin, begin + std::strlen(text)};
}

/// A protocol in which the client talks first and answers every byte.
class TalkingCodec : public StateCodec {
 public:
  Bytes begin() override { return bytes_of("hello"); }
  CodecOutput decode(std::span<const std::byte> bytes, Clock::time_point) override {
    CodecOutput output;
    output.messages = bytes.size();
    output.reply = {bytes.begin(), bytes.end()};
    return output;
  }
};

/// A shell whose executor runs only when the test says so.
class LinkShellTest : public testing::Test {
 protected:
  ~LinkShellTest() override {
    if (shell_) shell_->stop();
  }
  void start(std::unique_ptr<StateCodec> codec) {
    shell_ = std::make_shared<LinkShell>(context_.get_executor(), "127.0.0.1", peer_.port(),
                                         LinkMachine(std::move(codec), {}), recorder_.events());
    shell_->start();
  }
  template <class Condition>
  bool run_until(Condition condition) {
    const auto deadline = Clock::now() + kPatience;
    while (!condition() && Clock::now() < deadline) context_.run_for(1ms);
    return condition();
  }
  PeerConnection connect() {
    EXPECT_TRUE(run_until([&] { return shell_->health().connects == 1; }));
    return peer_.accept();
  }

  boost::asio::io_context context_;
  StatePeer peer_;
  LinkRecorder recorder_;
  std::shared_ptr<LinkShell> shell_;
};

TEST_F(LinkShellTest, StampsWithTheArrivalNotWithTheReading) {
  start(std::make_unique<SimpleMessageCodec>(SimpleMessageSettings{}));
  PeerConnection connection = connect();
  // Linux begins to stamp a moment after the first socket has asked for it, so the first message may miss
  // out.
  bool stamped_with_arrival = false;
  for (std::size_t count = 1; count <= 20 && !stamped_with_arrival; ++count) {
    const auto before = Clock::now();
    connection.send(simple_message::live_first_cycle("bswap/feedback"));
    const auto after = Clock::now();
    std::this_thread::sleep_until(after + 100ms);  // the process is busy elsewhere
    ASSERT_TRUE(run_until([&] { return recorder_.joints.size() == count; }));
    const auto stamp = recorder_.joints.back().stamp;
    stamped_with_arrival = stamp > before - 1ms && stamp < after + 50ms;
  }
  EXPECT_TRUE(stamped_with_arrival);
}

TEST_F(LinkShellTest, DeliversOneSampleOfABacklogTheNewest) {
  start(std::make_unique<SimpleMessageCodec>(SimpleMessageSettings{}));
  PeerConnection connection = connect();
  constexpr int kCycles = 300;  // several reads
  for (int i = 0; i < kCycles; ++i) connection.send(simple_message::live_first_cycle("bswap/feedback"));
  ASSERT_TRUE(run_until([&] { return shell_->health().messages == 2 * kCycles; }));
  EXPECT_EQ(recorder_.joints.size(), 1u);
  EXPECT_EQ(recorder_.joints.back().sequence, static_cast<std::uint64_t>(kCycles));
}

TEST_F(LinkShellTest, SendsWhatACodecWantsToSay) {
  start(std::make_unique<TalkingCodec>());
  PeerConnection connection = connect();
  EXPECT_EQ(connection.receive(5), bytes_of("hello"));
  connection.send(bytes_of("how are you?"));
  ASSERT_TRUE(run_until([&] { return shell_->health().messages == 12; }));
  EXPECT_EQ(connection.receive(12), bytes_of("how are you?"));
}

TEST_F(LinkShellTest, RestsBetweenMessages) {
  start(std::make_unique<SimpleMessageCodec>(SimpleMessageSettings{}));
  PeerConnection connection = connect();
  for (int i = 0; i < 4; ++i) {
    connection.send(simple_message::live_first_cycle("bswap/feedback"));
    EXPECT_LT(context_.run_for(100ms), 20u) << "completions";
  }
}

TEST_F(LinkShellTest, MayOutliveItsExecutorsLastRun) {
  start(std::make_unique<TalkingCodec>());
  PeerConnection connection = connect();
  connection.send(bytes_of("x"));
  shell_->stop();
  shell_.reset();  // the context still holds completions
}

}  // namespace
}  // namespace calibrd
