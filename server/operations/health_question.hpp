// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace calibrd {

/// What a daemon on this machine is asked, and how its answer is believed.
struct HealthQuestion {
  std::string address;  ///< as configured; that of any interface stands for this machine
  std::uint16_t port = 0;
  std::string path = "/livez";
  std::chrono::milliseconds within{5000};  ///< for all of it: connection, handshake and answer
  bool tls = false;
  std::filesystem::path
      ca;            ///< PEM; empty: no certificate is verified, which only the loopback address may do
  std::string name;  ///< what the certificate is for; empty: the address that is asked
  std::filesystem::path certificate;  ///< of the client, with its key in `key`; empty: none is shown
  std::filesystem::path key;
};

struct HealthAnswer {
  bool healthy = false;  ///< the daemon answered 200
  std::string line;      ///< the answer in words; where it is not healthy: why, and what to do
};

/// Asks once and returns within `question.within`.
HealthAnswer ask_health(const HealthQuestion& question);

}  // namespace calibrd
