// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "core/base/heartbeat.hpp"

namespace calibrd::api {

/// Beats as long as the executor it is spawned on runs what is ready. Ends with the executor's context;
/// `heartbeat` must outlive that.
inline boost::asio::awaitable<void> keep_beating(Heartbeat& heartbeat) {
  boost::asio::steady_timer pause(co_await boost::asio::this_coro::executor);
  for (;;) {
    heartbeat.beat();
    pause.expires_after(std::chrono::milliseconds(250));
    co_await pause.async_wait(boost::asio::use_awaitable);
  }
}

}  // namespace calibrd::api
