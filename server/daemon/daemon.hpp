// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "api/http/http_server.hpp"
#include "core/base/result.hpp"
#include "server/config/config.hpp"
#include "server/operations/notify_socket.hpp"

namespace calibrd {

/// Who is told how the daemon is; all may be absent.
struct ServiceManager {
  const NotifySocket* socket = nullptr;  ///< must outlive the daemon
  std::optional<std::chrono::microseconds> watchdog;
};

/// The running daemon: robot link, sensors, store and HTTP server wired together.
class Daemon {
 public:
  /// Runs when it returns. Whether robot and sensors are there shows in the API: they may come and go at any
  /// time. `configuration`: the same as text, which is kept with every calibration. The error names the file,
  /// key or port at fault.
  static Result<std::unique_ptr<Daemon>> start(const Config& config, api::Entrance entrance,
                                               const std::string& version, const std::string& configuration,
                                               const ServiceManager& manager = {});
  ~Daemon();

  /// Takes the port and reads the key, which may need rights that the daemon gives up then (server.run_as).
  /// The error names the file, key or port at fault.
  static Result<api::Entrance> open(const Config& config);

  /// Takes over the live keys of a configuration (with_live_keys()), and reads certificates again. With an
  /// error nothing has changed.
  Status apply(const Config& config);
  /// That a configuration was read again, for the audit log: changed keys, or why it was not taken over.
  void note_reload(bool is_done, const std::string& detail);

  /// Ends everything in good order.
  void stop();

  std::uint16_t http_port() const;

 private:
  struct Parts;
  explicit Daemon(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace calibrd
