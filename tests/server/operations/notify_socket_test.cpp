// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/notify_socket.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/server/operations/notify_peer.hpp"

namespace calibrd {
namespace {

std::string name_of_test() { return "calibrd-notify-" + std::to_string(getpid()); }

TEST(NotifySocket, SpeaksToAnAbstractSocket) {
  const auto address = "@" + name_of_test();
  const NotifyPeer manager(address);
  const auto socket = NotifySocket::open(address);
  ASSERT_TRUE(socket);
  EXPECT_TRUE(socket->send("READY=1\nSTATUS=well"));
  EXPECT_EQ(manager.receive(), "READY=1\nSTATUS=well");
}

TEST(NotifySocket, SpeaksToASocketInTheFileSystem) {
  const auto address = "/tmp/" + name_of_test();
  const NotifyPeer manager(address);
  const auto socket = NotifySocket::open(address);
  ASSERT_TRUE(socket);
  EXPECT_TRUE(socket->send("STOPPING=1"));
  EXPECT_EQ(manager.receive(), "STOPPING=1");
  unlink(address.c_str());
}

TEST(NotifySocket, NobodyThereIsNoHarm) {
  const auto socket = NotifySocket::open("@" + name_of_test() + "-nobody");
  ASSERT_TRUE(socket);
  EXPECT_FALSE(socket->send("READY=1"));
}

TEST(NotifySocket, RefusesWhatIsNoAddress) {
  for (const auto& address :
       {std::string(), std::string("@"), std::string("relative"), "/" + std::string(200, 'x')})
    EXPECT_FALSE(NotifySocket::open(address)) << address;
}

TEST(NotifyOrders, AreTakenOutOfTheEnvironment) {
  setenv("NOTIFY_SOCKET", "@somewhere", 1);
  setenv("WATCHDOG_USEC", "3000000", 1);
  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  const auto orders = take_notify_orders();
  EXPECT_EQ(orders.address, "@somewhere");
  EXPECT_EQ(orders.watchdog, std::chrono::seconds(3));
  EXPECT_EQ(std::getenv("NOTIFY_SOCKET"), nullptr) << "children would speak for the daemon";
  EXPECT_EQ(std::getenv("WATCHDOG_USEC"), nullptr);
  EXPECT_FALSE(take_notify_orders().watchdog);
}

TEST(NotifyOrders, AWatchdogForAnotherProcessIsNotOurs) {
  setenv("WATCHDOG_USEC", "3000000", 1);
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(take_notify_orders().watchdog);
  setenv("WATCHDOG_USEC", "soon", 1);
  EXPECT_FALSE(take_notify_orders().watchdog);
}

TEST(Reloading, TellsTheMonotonicTimeThatSystemdWants) {
  EXPECT_TRUE(reloading_lines().starts_with("RELOADING=1\nMONOTONIC_USEC="));
}

}  // namespace
}  // namespace calibrd
