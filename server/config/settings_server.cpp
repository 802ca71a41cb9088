// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/config_error.hpp"
#include "server/config/quoted.hpp"
#include "server/config/section_declarer.hpp"

namespace calibrd {

Kind<std::vector<std::string>> texts() {
  return {
      "list of texts",
      [](const RawValue& value) -> Result<std::vector<std::string>> {
        const Error wrong{ConfigError::bad_value, "this is not a list of texts; write [\"one\", \"two\"]"};
        const auto* list = std::get_if<std::vector<RawValue>>(&value.data);
        if (!list) return wrong;
        std::vector<std::string> all;
        for (const auto& element : *list) {
          const auto* text = std::get_if<std::string>(&element.data);
          if (!text) return wrong;
          all.push_back(*text);
        }
        return all;
      },
      [](const std::vector<std::string>& value) {
        std::string list;
        for (const auto& one : value) list.append(list.empty() ? "" : ", ").append(quoted(one));
        return "[" + list + "]";
      }};
}

namespace {

void declare_tls(std::vector<Setting>& table) {
  SectionDeclarer<TlsConfig> key(table, {"server", "tls"},
                                 [](Config& c, const Names&) -> TlsConfig& { return c.server.tls; });
  key("certificate", &TlsConfig::certificate, path(), "",
      "PEM file: the server's certificate, then those between it and the root. Empty: no TLS. A SIGHUP reads "
      "it, the key and client_ca again.")
      .live = true;
  key("key", &TlsConfig::key, path(), "", "PEM file with its key.").live = true;
  key("key_password_file", &TlsConfig::key_password_file, path(), "",
      "File whose first line is the password of the key, where it has one.")
      .live = true;
  key("client_ca", &TlsConfig::client_ca, path(), "",
      "PEM file: clients must show a certificate of one of these authorities. Empty: they need none.")
      .live = true;
}

}  // namespace

void declare_server(std::vector<Setting>& table) {
  SectionDeclarer<ServerConfig> key(table, {"server"},
                                    [](Config& c, const Names&) -> ServerConfig& { return c.server; });
  key("address", &ServerConfig::address, text(), "",
      "Address the HTTP server listens on. 0.0.0.0 opens it to the network, which takes tokens_file or "
      "allow_unauthenticated.");
  key("port", &ServerConfig::port, integer(0, 65535), "",
      "TCP port of the HTTP server. 0 takes any free port and logs it.");
  key("max_connections", &ServerConfig::max_connections, integer(1, 10000), "",
      "Connections served at a time; more are answered 503.")
      .live = true;
  key("tokens_file", &ServerConfig::tokens_file, path(), "",
      "Tokens that clients must have (calibrd token create); read again when it changes. Empty: no token is "
      "asked for. docs/security.md.");
  key("allow_unauthenticated", &ServerConfig::allow_unauthenticated, flag(), "",
      "Lets the server listen on an address that other machines reach without asking for tokens.");
  key("hosts", &ServerConfig::hosts, texts(), "",
      "Names under which clients reach this daemon, beside localhost and IP addresses; others are answered "
      "421. [\"*\"]: any.")
      .live = true;
  key("rate_limit", &ServerConfig::rate_limit, integer(0, 1'000'000), "1/s",
      "Requests of one client address; more are answered 429. 0: any number.")
      .live = true;
  key("loopback_rate_limit", &ServerConfig::loopback_rate_limit, integer(0, 1'000'000), "1/s",
      "The same for all clients on this machine together.")
      .live = true;
  key("run_as", &ServerConfig::run_as, text(), "",
      "User that a daemon started by root goes on as, once it has its port and has read its key. Empty: the "
      "one that started it.");
  declare_tls(table);
}

void declare_audit(std::vector<Setting>& table) {
  SectionDeclarer<AuditConfig> key(table, {"audit"},
                                   [](Config& c, const Names&) -> AuditConfig& { return c.audit; });
  key("max_file_mb", &AuditConfig::max_file_mb, integer(1, 10'000), "MB",
      "audit.jsonl, beside storage.path, holds who changed what; a new one is begun at this size.");
  key("files", &AuditConfig::files, integer(1, 1000), "", "So many are kept, the oldest goes first.");
}

}  // namespace calibrd
