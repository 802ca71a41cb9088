// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/tcp_socket.hpp"

#include <gtest/gtest.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/io_context.hpp>

#include "tests/drivers/robot/state_peer.hpp"

namespace calibrd {
namespace {

using Tcp = boost::asio::ip::tcp;

class TcpSocketTest : public testing::Test {
 protected:
  Tcp::endpoint to(std::uint16_t port) const { return {boost::asio::ip::address_v4::loopback(), port}; }
  int option(int level, int name) {
    int value = 0;
    socklen_t size = sizeof value;
    EXPECT_EQ(::getsockopt(socket_.native_handle(), level, name, &value, &size), 0);
    return value;
  }
  boost::asio::io_context context_;
  Tcp::socket socket_{context_};
};

TEST_F(TcpSocketTest, IsTunedToNoticeADeadPeer) {
  StatePeer peer;
  socket_.connect(to(peer.port()));
  tune_state_socket(socket_);
  EXPECT_NE(option(IPPROTO_TCP, TCP_NODELAY), 0);
  EXPECT_NE(option(SOL_SOCKET, SO_KEEPALIVE), 0);
  EXPECT_EQ(option(IPPROTO_TCP, TCP_KEEPIDLE), 5);
  EXPECT_EQ(option(IPPROTO_TCP, TCP_KEEPINTVL), 1);
  EXPECT_EQ(option(IPPROTO_TCP, TCP_KEEPCNT), 3);
  EXPECT_EQ(option(IPPROTO_TCP, TCP_USER_TIMEOUT), 3000);
}

TEST_F(TcpSocketTest, KnowsAConnectionThatMetItself) {
  socket_.open(Tcp::v4());
  socket_.bind(to(0));
  const std::uint16_t own_port = socket_.local_endpoint().port();
  socket_.connect(to(own_port));
  EXPECT_TRUE(connected_to_itself(socket_));
}

TEST_F(TcpSocketTest, DoesNotTakeAPeerForItself) {
  StatePeer peer;
  socket_.connect(to(peer.port()));
  EXPECT_FALSE(connected_to_itself(socket_));
  EXPECT_FALSE(connected_to_itself(Tcp::socket(context_)));
}

TEST_F(TcpSocketTest, ReadsWithoutWaitingAndSeesTheEnd) {
  StatePeer peer;
  socket_.connect(to(peer.port()));
  PeerConnection connection = peer.accept();
  std::byte buffer[16];
  EXPECT_EQ(read_stamped(socket_, buffer).error, std::errc::operation_would_block);

  connection.send(std::vector<std::byte>(3));
  connection.close();
  socket_.wait(Tcp::socket::wait_read);
  EXPECT_EQ(read_stamped(socket_, buffer).size, 3u);
  socket_.wait(Tcp::socket::wait_read);
  const StampedRead end = read_stamped(socket_, buffer);
  EXPECT_EQ(end.size, 0u);
  EXPECT_FALSE(end.error);
}

}  // namespace
}  // namespace calibrd
