// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/header_gate.hpp"

#include <gtest/gtest.h>

#include <tuple>

namespace calibrd::api {
namespace {

using Verdict = HeaderGate::Verdict;

constexpr std::size_t kLimit = 8192;

/// The verdict on bytes that come in pieces of `piece`.
Verdict look(HeaderGate& gate, std::string_view bytes, std::size_t piece) {
  auto verdict = Verdict::read_more;
  for (std::size_t shown = 0; shown < bytes.size() && verdict == Verdict::read_more;) {
    shown = std::min(shown + piece, bytes.size());
    verdict = gate.look(bytes.substr(0, shown));
  }
  return verdict;
}

Verdict verdict_on(std::string_view bytes) {
  HeaderGate whole(kLimit), bit_by_bit(kLimit);
  const auto verdict = look(whole, bytes, bytes.size());
  EXPECT_EQ(look(bit_by_bit, bytes, 1), verdict) << "pieces make a difference: " << bytes;
  if (verdict == Verdict::passed) {
    EXPECT_EQ(whole.size(), bit_by_bit.size());
  }
  return verdict;
}

/// A request with these header lines beside its Host.
std::string with_fields(const std::string& fields) {
  return "POST /a HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n";
}

std::string with_target(const std::string& target) {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
}

TEST(HeaderGate, LetsWellFormedRequestsThrough) {
  for (const auto& bytes :
       {with_fields(""), with_fields("Content-Length: 12\r\n"), with_fields("transfer-encoding: Chunked\r\n"),
        with_fields("X-Odd_Name.1: \tany \"text\" \xc3\xa4\r\n"), with_fields("Empty:\r\n"),
        std::string("GET /?a=b&c=%20 HTTP/1.0\r\nHOST:[::1]:8080\r\n\r\n"),
        with_target("/api/v1/sensors/kin-ect.2/clouds/measured?frame=base"), with_target("/a..b/.c/...")})
    EXPECT_EQ(verdict_on(bytes), Verdict::passed) << bytes;
}

TEST(HeaderGate, ItsSizeIsThatOfTheHeaderAlone) {
  HeaderGate gate(kLimit);
  const auto header = with_fields("Content-Length: 2\r\n");
  ASSERT_EQ(gate.look(header + "{}GET /next"), Verdict::passed);
  EXPECT_EQ(gate.size(), header.size());
}

TEST(HeaderGate, RefusesWhatReadersUnderstandDifferently) {
  for (const auto& fields : {"Content-Length: 1\r\nContent-Length: 1\r\n",
                             "Content-Length: 1\r\nContent-Length: 2\r\n",
                             "Content-Length: 1, 1\r\n",
                             "Content-Length: +1\r\n",
                             "Content-Length: 0x1\r\n",
                             "Content-Length:\r\n",
                             "Content-Length: 9999999999999\r\n",
                             "Content-Length: 1\r\nTransfer-Encoding: chunked\r\n",
                             "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n",
                             "Transfer-Encoding: gzip, chunked\r\n",
                             "Transfer-Encoding: xchunked\r\n",
                             "Transfer-Encoding: \r\n",
                             "Host: other\r\n",
                             "X: a\r\n b\r\n",
                             "Name : b\r\n",
                             " X: a\r\n",
                             "no colon\r\n",
                             ": none\r\n",
                             "X: a\nY: b\r\n",
                             "X: a\rb\r\n",
                             "X: \x01\r\n",
                             "X: \x7f\r\n",
                             "N\xc3\xa4me: a\r\n",
                             "Authorization: a\r\nauthorization: b\r\n"})
    EXPECT_EQ(verdict_on(with_fields(fields)), Verdict::refused) << fields;
  EXPECT_EQ(verdict_on(with_fields(std::string("X: a\0b\r\n", 9))), Verdict::refused);
}

TEST(HeaderGate, RefusesAHostThatIsMissingOrNone) {
  EXPECT_EQ(verdict_on("GET / HTTP/1.1\r\n\r\n"), Verdict::refused);
  for (const auto* host : {"", "a b", "a/b", "a@b", "a:b", "a:99999", "[::1", "[x]", "a:", "a,b"})
    EXPECT_EQ(verdict_on(std::string("GET / HTTP/1.1\r\nHost: ") + host + "\r\n\r\n"), Verdict::refused)
        << host;
}

TEST(HeaderGate, RefusesFirstLinesThatAreNone) {
  for (const auto* line :
       {"", "GET", "GET /", "GET  / HTTP/1.1", "GET / HTTP/1.1 ", " GET / HTTP/1.1", "GET / http/1.1",
        "GET / HTTP/2.0", "GET / HTTP/1.10", "GET\t/ HTTP/1.1", "G@T / HTTP/1.1", "GET / HTTP/1.1\x01",
        "LONGLONGLONGLONGLONG / HTTP/1.1", "\x16\x03\x01", "GET /\xc3\xa4 HTTP/1.1"})
    EXPECT_EQ(verdict_on(std::string(line) + "\r\nHost: localhost\r\n\r\n"), Verdict::refused) << line;
}

TEST(HeaderGate, RefusesTargetsThatHideSomething) {
  for (const auto* target : {"*",
                             "http://localhost/livez",
                             "localhost:8080",
                             "/a/../b",
                             "/..",
                             "/.",
                             "/./a",
                             "/a/..?b",
                             "/%2e%2e/a",
                             "/a/%2E",
                             "/a%2fb",
                             "/a%5Cb",
                             "/%00",
                             "/a?b=%00",
                             "/%0a",
                             "/%7f",
                             "/%",
                             "/%4",
                             "/%g1",
                             "/a?%",
                             "/a#b",
                             "/a\\b",
                             "/a\"b",
                             "/<a>",
                             "/a|b",
                             "/{a}",
                             "/a^b"})
    EXPECT_EQ(verdict_on(with_target(target)), Verdict::refused) << target;
}

TEST(HeaderGate, RefusesAtTheFirstWrongByteNotAtTheEnd) {
  HeaderGate gate(kLimit);
  EXPECT_EQ(gate.look("GET / HTTP/1.1\n"), Verdict::refused);
  EXPECT_EQ(gate.refusal().code, ApiError::bad_request);
}

TEST(HeaderGate, RefusesTooMuchOfIt) {
  HeaderGate endless(kLimit);
  EXPECT_EQ(endless.look("GET / HTTP/1.1\r\nX: " + std::string(1 << 20, 'x')), Verdict::refused);
  EXPECT_EQ(endless.refusal().code, ApiError::header_too_large);
  std::string many;
  for (int i = 0; i < 65; ++i) many += "A: b\r\n";
  HeaderGate gate(kLimit);
  EXPECT_EQ(gate.look(with_fields(many)), Verdict::refused);
  EXPECT_EQ(gate.refusal().code, ApiError::header_too_large);
}

TEST(HeaderGate, WaitsForTheEnd) {
  EXPECT_EQ(verdict_on("GET / HTTP/1.1\r\nHost: localhost\r\n"), Verdict::read_more);
}

}  // namespace
}  // namespace calibrd::api
