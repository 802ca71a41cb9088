// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Bytes of a connection, read with the parser and the limits of the server's sessions, answered by all routes
// over a fake cell. Input: bit 0 whether there is a pose; how the bytes are cut; then the bytes.
#include <boost/asio/buffer.hpp>

#include "api/http/header_gate.hpp"
#include "api/http/request_message.hpp"
#include "api/routes/routes.hpp"
#include "tests/api/fake_cell.hpp"
#include "tests/api/fake_operations.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/response_check.hpp"

namespace {

using namespace calibrd;
using boost::beast::error_code;

/// Whether the gate lets the header through, however it is cut.
bool passes_gate(std::string_view bytes, std::size_t piece) {
  api::HeaderGate gate(api::HttpServerSettings{}.header_limit);
  for (std::size_t shown = 0; shown < bytes.size();) {
    shown = std::min(shown + piece, bytes.size());
    const auto verdict = gate.look(bytes.substr(0, shown));
    if (verdict == api::HeaderGate::Verdict::passed) return true;
    if (verdict == api::HeaderGate::Verdict::refused) return false;
  }
  return false;
}

/// Feeds the parser until a request is complete. Returns what is left of the bytes, or nothing when they hold
/// no whole request.
std::optional<std::string_view> read(api::RequestParser& parser, std::string_view bytes, std::size_t piece) {
  std::size_t shown = 0, used = 0;  // shown: bytes that have "arrived"
  while (!parser.is_done()) {
    if (shown == bytes.size()) return std::nullopt;
    shown = std::min(shown + piece, bytes.size());
    error_code failure;
    while (used < shown && !parser.is_done()) {
      const std::size_t took = parser.put(boost::asio::buffer(bytes.data() + used, shown - used), failure);
      used += took;
      if (failure == boost::beast::http::error::need_more || took == 0) break;
      if (failure) return api::problem_of(failure), std::nullopt;
    }
    if (failure && failure != boost::beast::http::error::need_more) return std::nullopt;
  }
  fuzz::require(parser.get().body().size() <= api::HttpServerSettings{}.body_limit,
                "no body beyond the limit");
  return bytes.substr(used);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  api::FakeCell cell;
  if (input.byte() & 1U) cell.make_calibrated();
  const std::size_t piece = 1 + 16U * input.byte();
  const api::EventHub events("run");
  const api::FakeOperations operations;
  const api::Router router = api::make_routes(cell, events, operations);
  std::optional<std::string_view> rest = input.text();
  while (rest && !rest->empty()) {
    if (!passes_gate(*rest, piece)) break;
    api::RequestParser parser;
    api::set_limits(parser, {});
    parser.eager(true);
    rest = read(parser, *rest, piece);
    if (!rest) break;
    auto message = parser.release();
    auto request = api::request_of(message);
    if (!request) continue;
    request->body = std::move(message.body());
    router.scope(*request);
    router.cost(*request);
    fuzz::check_response(router.answer(*request));
  }
  return 0;
}
