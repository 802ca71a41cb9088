// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>
#include <cerrno>
#include <optional>
#include <thread>

#include "drivers/sim/controller/controller_server.hpp"
#include "drivers/sim/world/sim_error.hpp"
#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Settings = ControllerSettings;

constexpr std::int32_t kPosition = 10, kStatus = 13, kFeedback = 15, kFeedbackEx = 2017;

struct Received {
  std::int32_t type = 0;
  Bytes body;
  bool big = true;

  std::uint32_t word(std::size_t at) const {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | body[at + (big ? i : 3 - i)];
    return value;
  }
  float real(std::size_t at) const { return std::bit_cast<float>(word(at)); }
  double joint(std::size_t index) const { return real((type == kPosition ? 4 : 12) + 4 * index); }
};

/// A blocking client of the controller, with a limit on every wait.
class Client {
 public:
  explicit Client(std::uint16_t port) : socket_(io_) {
    socket_.connect({asio::ip::address_v4::loopback(), port});
    timeval limit{5, 0};
    ::setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
  }

  /// Nothing when the connection ended or nothing came for a long time.
  std::optional<Received> next(bool big = true) {
    Bytes head;
    if (!read(head, 16)) return std::nullopt;
    Received message{0, head, big};
    const std::uint32_t length = message.word(0);
    message.type = static_cast<std::int32_t>(message.word(4));
    Bytes body;
    if (length < 12 || length > 1024 || !read(body, length - 12)) return std::nullopt;
    message.body = body;
    return message;
  }

  std::optional<Received> next_of(std::int32_t type, bool big = true) {
    for (int i = 0; i < 1000; ++i) {
      auto message = next(big);
      if (!message || message->type == type) return message;
    }
    return std::nullopt;
  }

  /// The error with which the connection ends, reading all that comes before.
  std::optional<int> ending() {
    std::array<std::uint8_t, 512> bytes;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (std::chrono::steady_clock::now() < deadline) {
      const auto got = ::recv(socket_.native_handle(), bytes.data(), bytes.size(), 0);
      if (got == 0) return 0;
      if (got < 0) return errno;
    }
    return std::nullopt;
  }

  tcp::socket& socket() { return socket_; }

 private:
  bool read(Bytes& bytes, std::size_t count) {
    bytes.resize(count);
    std::size_t at = 0;
    while (at < count) {
      const auto got = ::recv(socket_.native_handle(), bytes.data() + at, count - at, 0);
      if (got <= 0) return false;
      at += static_cast<std::size_t>(got);
    }
    return true;
  }

  asio::io_context io_;
  tcp::socket socket_;
};

/// A controller on a thread of its own; do() runs something there.
class Controller : public testing::Test {
 protected:
  Controller()
      : world_(test::world_from("")),
        server_(io_, [this]() -> const WorldState& { return world_.state; }, {}) {
    EXPECT_TRUE(server_.listen(0));
    thread_ = std::thread([this] { io_.run(); });
  }
  ~Controller() override {
    run([this] { server_.stop(); });
    io_.stop();
    thread_.join();
  }

  template <class Work>
  std::invoke_result_t<Work> run(Work work) {
    return asio::post(io_, asio::use_future(work)).get();
  }
  void set(const std::function<void(Settings&)>& change) {
    run([&] {
      Settings settings = server_.settings();
      change(settings);
      EXPECT_TRUE(server_.apply(settings));
    });
  }
  std::size_t clients() {
    return run([this] { return server_.client_count(); });
  }

  World world_;
  asio::io_context io_;
  ControllerServer server_;
  std::thread thread_;
};

TEST_F(Controller, SendsFeedbackThenStatusForEver) {
  Client client(server_.port());
  for (int i = 0; i < 5; ++i) {
    const auto feedback = client.next();
    ASSERT_TRUE(feedback);
    EXPECT_EQ(feedback->type, kFeedback);
    EXPECT_EQ(feedback->word(4), 6U);  // position and velocity
    EXPECT_EQ(feedback->word(8), 0U);  // no time
    const auto status = client.next();
    ASSERT_TRUE(status);
    EXPECT_EQ(status->type, kStatus);
  }
}

TEST_F(Controller, SendsAboutFortyCyclesPerSecond) {
  Client client(server_.port());
  ASSERT_TRUE(client.next_of(kStatus));
  const auto from = std::chrono::steady_clock::now();
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(client.next_of(kFeedback));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - from;
  EXPECT_GT(took.count(), 0.97);  // a sleep of 25 ms in every cycle; a busy machine makes it longer
}

TEST_F(Controller, ReportsTrueJointsLessTheZeros) {
  run([&] {
    world_.state.motion.place({0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}, 0);
    world_.state.joint_zero_rad = {0.01, 0, 0, 0, 0, 0, -0.02};
  });
  Client client(server_.port());
  const auto feedback = client.next_of(kFeedback);
  ASSERT_TRUE(feedback);
  EXPECT_NEAR(feedback->joint(0), 0.09, 1e-6);
  EXPECT_NEAR(feedback->joint(3), 0.4, 1e-6);
  EXPECT_NEAR(feedback->joint(6), 0.72, 1e-6);
  EXPECT_EQ(feedback->joint(7), 0.0);
}

TEST_F(Controller, SpeaksLittleEndianWhenTold) {
  set([](Settings& s) { s.big_endian = 0; });
  Client client(server_.port());
  ASSERT_TRUE(client.next_of(kFeedback, false));
}

TEST_F(Controller, SendsJointPositionsAsOtherMakesDo) {
  set([](Settings& s) { s.protocol = Settings::Protocol::joint_position; });
  Client client(server_.port());
  EXPECT_EQ(client.next()->type, kPosition);
  EXPECT_EQ(client.next()->type, kStatus);
}

TEST_F(Controller, SendsAllGroupsAndTheirSummary) {
  set([](Settings& s) { s.groups = 2; });
  Client client(server_.port());
  ASSERT_TRUE(client.next_of(kStatus));
  for (std::uint32_t group : {0U, 1U}) {
    const auto feedback = client.next();
    EXPECT_EQ(feedback->type, kFeedback);
    EXPECT_EQ(feedback->word(0), group);
  }
  const auto summary = client.next();
  EXPECT_EQ(summary->type, kFeedbackEx);
  EXPECT_EQ(summary->word(0), 2U);
  EXPECT_EQ(summary->body.size(), 532U);
}

TEST_F(Controller, FifthClientThrowsOutTheFirst) {
  std::vector<std::unique_ptr<Client>> first_four;
  for (int i = 0; i < 4; ++i) {
    first_four.push_back(std::make_unique<Client>(server_.port()));
    ASSERT_TRUE(first_four.back()->next());
  }
  Client fifth(server_.port());
  EXPECT_TRUE(fifth.next());
  EXPECT_TRUE(first_four[0]->ending());
  for (int i = 1; i < 4; ++i) EXPECT_TRUE(first_four[static_cast<std::size_t>(i)]->next());
  EXPECT_EQ(clients(), 4U);
}

TEST_F(Controller, NeverReadsItsSocket) {
  Client client(server_.port());
  const Bytes ping{0, 0, 0, 12, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0};
  for (int i = 0; i < 10; ++i) asio::write(client.socket(), asio::buffer(ping));
  for (int i = 0; i < 10; ++i) {
    const auto message = client.next();
    ASSERT_TRUE(message);
    EXPECT_TRUE(message->type == kFeedback || message->type == kStatus);
  }
}

TEST_F(Controller, FrozenGoesOnSendingOldJoints) {
  run([&] { world_.state.motion.place({0.5}, 0); });
  Client client(server_.port());
  ASSERT_TRUE(client.next());
  set([](Settings& s) { s.mode = Settings::Mode::frozen; });
  run([&] { world_.state.motion.place({-0.5}, 0); });
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(client.next_of(kFeedback)->joint(0), 0.5, 1e-6);
  set([](Settings& s) { s.mode = Settings::Mode::normal; });
  EXPECT_TRUE(test::eventually([&] { return std::abs(client.next_of(kFeedback)->joint(0) + 0.5) < 1e-6; }));
}

TEST_F(Controller, StatusOnlySendsNoJoints) {
  set([](Settings& s) { s.mode = Settings::Mode::status_only; });
  Client client(server_.port());
  for (int i = 0; i < 6; ++i) EXPECT_EQ(client.next()->type, kStatus);
}

TEST_F(Controller, SilentKeepsTheConnection) {
  Client client(server_.port());
  ASSERT_TRUE(client.next());
  set([](Settings& s) { s.mode = Settings::Mode::silent; });
  EXPECT_EQ(clients(), 1U);
  set([](Settings& s) { s.mode = Settings::Mode::normal; });
  EXPECT_TRUE(client.next_of(kStatus));
}

TEST_F(Controller, RefusesAndComesBackOnTheSamePort) {
  Client client(server_.port());
  ASSERT_TRUE(client.next());
  set([](Settings& s) { s.mode = Settings::Mode::refuse; });
  EXPECT_TRUE(client.ending());
  EXPECT_THROW(Client(server_.port()), boost::system::system_error);
  set([](Settings& s) { s.mode = Settings::Mode::normal; });
  Client again(server_.port());
  EXPECT_TRUE(again.next());
}

TEST_F(Controller, DropsClientsByFinAndByReset) {
  for (const auto& [farewell, ending] : {std::pair{ControllerServer::Farewell::fin, 0},
                                         std::pair{ControllerServer::Farewell::reset, ECONNRESET}}) {
    Client client(server_.port());
    ASSERT_TRUE(client.next());
    run([&] { server_.drop_clients(farewell); });
    EXPECT_EQ(client.ending(), ending);
  }
}

TEST_F(Controller, ForgetsClientsThatLeft) {
  {
    Client client(server_.port());
    ASSERT_TRUE(client.next());
  }
  EXPECT_TRUE(test::eventually([&] { return clients() == 0; }));
}

TEST_F(Controller, PortInUseIsAnError) {
  asio::io_context io;
  ControllerServer second(io, [this]() -> const WorldState& { return world_.state; }, {});
  const Status listening = second.listen(server_.port());
  ASSERT_FALSE(listening);
  EXPECT_EQ(listening.error().code, make_error_code(SimError::cannot_listen));
}

}  // namespace
}  // namespace calibrd::sim
