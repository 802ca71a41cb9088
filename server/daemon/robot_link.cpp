// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/robot_link.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <optional>
#include <thread>

#include "api/http/beating.hpp"
#include "core/base/thread_name.hpp"

namespace calibrd {

namespace asio = boost::asio;

struct RobotLink::Impl {
  Heartbeat heartbeat;  // io refers to it
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  std::optional<StateClient> client;
  std::thread thread;
};

Result<std::unique_ptr<RobotLink>> RobotLink::create(const StateClientSettings& settings,
                                                     RobotLinkEvents events) {
  auto impl = std::make_unique<Impl>();
  auto client = StateClient::create(impl->io.get_executor(), settings, std::move(events));
  if (!client) return client.error();
  impl->client = *std::move(client);
  return std::unique_ptr<RobotLink>(new RobotLink(std::move(impl)));
}

RobotLink::RobotLink(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RobotLink::~RobotLink() { stop(); }

void RobotLink::start() {
  impl_->client->start();
  asio::co_spawn(impl_->io, api::keep_beating(impl_->heartbeat), asio::detached);
  impl_->thread = std::thread([this] {
    name_thread("robot link");
    impl_->io.run();
  });
}

void RobotLink::stop() {
  impl_->client->stop();
  impl_->work.reset();
  impl_->io.stop();
  if (impl_->thread.joinable()) impl_->thread.join();
}

const Heartbeat& RobotLink::heartbeat() const { return impl_->heartbeat; }

RobotLinkHealth RobotLink::health() const { return impl_->client->health(); }

}  // namespace calibrd
