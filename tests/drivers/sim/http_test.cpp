// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The program itself: started as a process, spoken to over real sockets.
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fstream>
#include <iterator>
#include <thread>

#include "tests/core/robot/scratch_folder.hpp"
#include "tests/drivers/sim/child_program.hpp"

namespace calibrd::sim {
namespace {

namespace http = boost::beast::http;
using boost::asio::ip::tcp;

/// calibrd-sim with the given arguments.
struct Program : test::ChildProgram {
  explicit Program(std::vector<std::string> arguments) : ChildProgram(command(std::move(arguments))) {}
  static std::vector<std::string> command(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), CALIBRD_SIM_PROGRAM);
    return arguments;
  }
};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What follows `key=` in the ready line, up to the next blank.
std::string value_of(const std::string& line, const std::string& key) {
  const auto from = line.find(key + "=") + key.size() + 1;
  return line.substr(from, line.find_first_of(" \n", from) - from);
}

class Sim : public testing::Test {
 protected:
  std::vector<std::string> arguments() const {
    return {"run",
            "--world",
            test::demo_world().string(),
            "--urdf",
            test::demo_urdf().string(),
            "--world-file",
            (folder_.path() / "world").string(),
            "--ready-file",
            (folder_.path() / "ready").string(),
            "--controller-port",
            "0",
            "--control-port",
            "0"};
  }
  /// The ready line.
  std::string ready() {
    EXPECT_TRUE(test::eventually([&] { return std::filesystem::exists(folder_.path() / "ready"); },
                                 std::chrono::seconds(60)));
    return text_of(folder_.path() / "ready");
  }
  http::response<http::string_body> request(const std::string& port, http::verb method,
                                            const std::string& target, const std::string& body) {
    boost::asio::io_context io;
    boost::beast::tcp_stream stream(io);
    stream.expires_after(std::chrono::seconds(10));
    stream.connect({boost::asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(std::stoi(port))});
    http::request<http::string_body> request{method, target, 11};
    request.body() = body;
    request.prepare_payload();
    http::write(stream, request);
    boost::beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(stream, buffer, response);
    return response;
  }

  calibrd::test::ScratchFolder folder_;
};

TEST_F(Sim, SaysWhereItIsAndAnswersThere) {
  Program program(arguments());
  const std::string line = ready();
  EXPECT_TRUE(line.starts_with("ready controller=127.0.0.1:"));
  EXPECT_TRUE(std::filesystem::exists(value_of(line, "world")));
  const std::string port = value_of(line, "control").substr(std::string("127.0.0.1:").size());
  const auto truth = request(port, http::verb::get, "/truth", "");
  EXPECT_EQ(truth.result(), http::status::ok);
  EXPECT_NE(truth.body().find("T_base_sensor"), std::string::npos);
  EXPECT_EQ(request(port, http::verb::put, "/motion", R"({"mode": "hold"})").result(), http::status::ok);
  EXPECT_EQ(request(port, http::verb::put, "/motion", "nonsense").result(), http::status::bad_request);
}

TEST_F(Sim, EndsWithinASecondOfSigterm) {
  Program program(arguments());
  const std::string world = value_of(ready(), "world");
  program.signal(SIGTERM);
  EXPECT_EQ(program.wait(std::chrono::seconds(1)), 0);
  EXPECT_FALSE(std::filesystem::exists(world));
}

TEST_F(Sim, RefusesUnusableInput) {
  constexpr std::chrono::seconds kSoon{30};
  EXPECT_EQ(Program({"run"}).wait(kSoon), 2);
  EXPECT_EQ(Program({}).wait(kSoon), 2);
  auto lost = arguments();
  lost[2] = "/nowhere/world.json";
  EXPECT_EQ(Program(lost).wait(kSoon), 2);
}

TEST_F(Sim, TakesNoPortThatIsTaken) {
  Program first(arguments());
  const std::string port = value_of(ready(), "control").substr(std::string("127.0.0.1:").size());
  auto taken = arguments();
  taken.back() = port;
  taken[6] = (folder_.path() / "other").string();
  taken[8] = (folder_.path() / "other_ready").string();
  EXPECT_EQ(Program(taken).wait(std::chrono::seconds(30)), 2);
}

}  // namespace
}  // namespace calibrd::sim
