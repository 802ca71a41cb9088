// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "api/access/audit_record.hpp"
#include "api/http/bound_address.hpp"
#include "api/http/door_settings.hpp"
#include "api/http/http_watch.hpp"
#include "api/http/tls_settings.hpp"
#include "api/routes/router.hpp"
#include "core/base/result.hpp"

namespace calibrd::api {

struct Tls;

/// What a server takes from the system, perhaps while the process still has the right to.
struct Entrance {
  std::shared_ptr<BoundAddress> address;
  std::shared_ptr<Tls> tls;  ///< null: plain HTTP
};

struct HttpServerSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;                       ///< 0: any free one
  int max_connections = 64;                        ///< more are answered 503 and closed
  int workers = 4;                                 ///< threads for slow routes
  std::chrono::milliseconds idle_timeout{60'000};  ///< between two requests of a connection
  std::chrono::milliseconds header_timeout{
      10'000};  ///< until the first request of a connection begins, and from there to the end of its header
  std::chrono::milliseconds body_timeout{10'000};
  std::chrono::milliseconds write_timeout{60'000};   ///< for a whole answer
  std::chrono::milliseconds stall_timeout{10'000};   ///< for each 64 KiB of it, about
  std::size_t most_unread = std::size_t{128} << 20;  ///< bytes of answers that clients have not taken yet
  std::uint32_t header_limit = 8 * 1024;
  std::uint64_t body_limit = 64 * 1024;
  DoorSettings door;
  TlsSettings tls;
  Entrance entrance = {};  ///< opened before; else the server does it itself
  /// Told of every request that was to change something, on a worker thread, before it is answered.
  std::function<void(const AuditRecord&)> audit;
};

/// What was asked and answered, for the log.
struct AccessRecord {
  std::string method;
  std::string path;
  int status = 0;
  std::string request_id;
  int route = -1;       ///< place in Router::routes(); -1: none
  std::string address;  ///< of the client
  std::chrono::microseconds duration{0};
};

/// Serves a router over HTTP/1.1. Quick routes are answered on its one network thread, slow ones on worker
/// threads, so that no quick answer ever waits for a slow one.
class HttpServer {
 public:
  /// Listens when it returns. `router` and `watch`, which may be null, must outlive the server. `log` is
  /// called on the network thread. Errors: HttpServerError, the detail naming address and port.
  static Result<std::unique_ptr<HttpServer>> start(const HttpServerSettings& settings, const Router& router,
                                                   std::function<void(const AccessRecord&)> log = {},
                                                   HttpWatch* watch = nullptr);
  ~HttpServer();

  /// Binds the address and reads the files of TLS. Errors: HttpServerError.
  static Result<Entrance> open(const HttpServerSettings& settings);

  /// Takes over what can change while it runs: `max_connections`, `door` and `tls`, whose files are read
  /// again. Open connections keep their certificate. With an error nothing changes.
  Status apply(const HttpServerSettings& settings);

  /// Takes no more connections, lets requests under way end within `grace`, then closes everything. Waits for
  /// slow routes that are still being answered: their service must let go first.
  void stop(std::chrono::milliseconds grace = std::chrono::milliseconds(300));

  std::uint16_t port() const;

 private:
  class Impl;
  explicit HttpServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace calibrd::api
