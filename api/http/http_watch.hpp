// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "api/metrics/metric.hpp"
#include "core/base/heartbeat.hpp"

namespace calibrd::api {

/// What an HTTP server shows of itself. Safe to read from any thread.
struct HttpWatch {
  Gauge connections;         ///< being served
  Counter accepted;          ///< connections that were served
  Counter refused;           ///< connections there was no room for
  Counter unreadable;        ///< requests that could not be read
  Gauge unread_bytes;        ///< of answers that clients have not taken yet
  Heartbeat network_thread;  ///< beats while it goes on
};

}  // namespace calibrd::api
