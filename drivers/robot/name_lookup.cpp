// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/name_lookup.hpp"

#include <netdb.h>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/post.hpp>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "drivers/robot/robot_link_error.hpp"

namespace calibrd {
namespace {

namespace asio = boost::asio;
using Endpoints = NameLookup::Endpoints;

Endpoints blocking_lookup(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_ADDRCONFIG;
  addrinfo* found = nullptr;
  Endpoints endpoints;
  if (::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) return endpoints;
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  for (const addrinfo* entry = found; entry; entry = entry->ai_next) {
    asio::ip::tcp::endpoint endpoint;
    if (entry->ai_addrlen > endpoint.capacity()) continue;
    std::memcpy(endpoint.data(), entry->ai_addr, entry->ai_addrlen);
    endpoint.resize(entry->ai_addrlen);
    endpoint.port(port);
    endpoints.push_back(endpoint);
  }
  return endpoints;
}

}  // namespace

/// Outlives the NameLookup while a thread is inside getaddrinfo(). The executor is touched only under the
/// mutex and while somebody still wants the answer, because its context may be gone afterwards.
struct NameLookup::Shared : std::enable_shared_from_this<Shared> {
  std::mutex mutex;
  bool running = false;
  Handler handler;
  asio::any_io_executor executor;

  void answer(Endpoints endpoints) {
    const std::lock_guard lock(mutex);
    running = false;
    if (!handler) return;
    asio::post(executor,
               [shared = shared_from_this(), endpoints = std::move(endpoints)] { shared->tell(endpoints); });
  }
  /// Must not throw, on a thread of its own: without memory for an answer there is none, and the caller's
  /// patience ends.
  void look_up(const std::string& host, std::uint16_t port) noexcept {
    try {
      answer(blocking_lookup(host, port));
    } catch (const std::exception&) {
      const std::lock_guard lock(mutex);
      running = false;
    }
  }
  void tell(const Endpoints& endpoints) {
    const Handler wanted = [this] {
      const std::lock_guard lock(mutex);
      return std::exchange(handler, nullptr);  // nothing after cancel()
    }();
    if (wanted) wanted(endpoints.empty() ? RobotLinkError::host_unknown : std::error_code{}, endpoints);
  }
};

NameLookup::NameLookup(asio::any_io_executor executor, std::string host, std::uint16_t port)
    : executor_(std::move(executor)),
      host_(std::move(host)),
      port_(port),
      shared_(std::make_shared<Shared>()) {}

void NameLookup::start(Handler handler) {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->handler = std::move(handler);
    shared_->executor = executor_;
    if (std::exchange(shared_->running, true)) return;
  }
  try {
    boost::system::error_code not_numeric;
    const auto address = asio::ip::make_address(host_, not_numeric);
    if (!not_numeric) return shared_->answer({{address, port_}});
    std::thread(&Shared::look_up, shared_, host_, port_).detach();
  } catch (...) {
    const std::lock_guard lock(shared_->mutex);
    shared_->running = false;  // the next start() tries again
    throw;
  }
}

void NameLookup::cancel() {
  const std::lock_guard lock(shared_->mutex);
  shared_->handler = nullptr;
  shared_->executor = {};
}

}  // namespace calibrd
