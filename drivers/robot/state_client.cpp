// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/state_client.hpp"

#include <utility>

#include "drivers/robot/link_shell.hpp"
#include "drivers/robot/robot_drivers.hpp"

namespace calibrd {

Result<StateClient> StateClient::create(const boost::asio::any_io_executor& executor,
                                        const StateClientSettings& settings, RobotLinkEvents events) {
  if (const Status checked = check(settings); !checked) return checked.error();
  LinkMachine machine(find_robot_driver(settings.driver)->make_codec(settings), settings.link);
  return StateClient(std::make_shared<LinkShell>(executor, settings.host,
                                                 static_cast<std::uint16_t>(settings.port),
                                                 std::move(machine), std::move(events)));
}

StateClient::StateClient(std::shared_ptr<LinkShell> shell) : shell_(std::move(shell)) {}
StateClient::StateClient(StateClient&&) noexcept = default;

StateClient& StateClient::operator=(StateClient&& other) noexcept {
  if (shell_) shell_->stop();
  shell_ = std::move(other.shell_);
  return *this;
}

StateClient::~StateClient() {
  if (shell_) shell_->stop();
}

void StateClient::start() { shell_->start(); }
void StateClient::stop() { shell_->stop(); }
RobotLinkHealth StateClient::health() const { return shell_->health(); }

}  // namespace calibrd
