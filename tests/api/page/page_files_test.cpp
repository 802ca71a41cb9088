// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/page/page_files.hpp"

#include <fstream>

#include "tests/api/routes/route_test.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd::api {
namespace {

namespace fs = std::filesystem;

/// A page of three files in a folder of its own.
class Page : public ::testing::Test {
 protected:
  Page() {
    fs::create_directories(folder_ / "assets");
    write("index.html", "<!doctype html>");
    write("assets/app-1a2b.js", "let x");
    write("assets/app-1a2b.js.gz", "compressed");
    write("secret.txt", "none of it");
    fs::create_symlink("/etc/passwd", folder_ / "assets/passwd.txt");
  }

  void write(const char* name, const char* text) const { std::ofstream(folder_ / name) << text; }

  Response get(const std::string& target, std::map<std::string, std::string> headers = {}) {
    const auto parsed = parse_target(target);
    return router_.answer({"GET", parsed->first, parsed->second, std::move(headers), {}});
  }
  static std::string header(const Response& response, const std::string& name) {
    for (const auto& [key, value] : response.headers)
      if (key == name) return value;
    return {};
  }

  const test::ScratchFolder scratch_;  ///< Tests run beside each other: to each a folder of its own.
  const fs::path folder_ = scratch_.path();
  FakeCell cell_;
  EventHub events_{"run"};
  FakeOperations operations_;
  Router router_;

 public:
  void SetUp() override { router_ = make_routes(cell_, events_, operations_, PageFiles::read(folder_)); }
};

TEST_F(Page, IsServedWithAPolicyThatKeepsItToItself) {
  const auto index = get("/");
  EXPECT_EQ(index.status, 200);
  EXPECT_EQ(index.body, "<!doctype html>");
  EXPECT_EQ(header(index, "Cache-Control"), "no-cache");
  const auto policy = header(index, "Content-Security-Policy");
  for (const auto* part :
       {"default-src 'none'", "script-src 'self'", "connect-src 'self'", "frame-ancestors 'none'"})
    EXPECT_NE(policy.find(part), std::string::npos) << part;
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
}

TEST_F(Page, ItsFilesAreKeptForEverAndComeCompressed) {
  const auto plain = get("/assets/app-1a2b.js");
  EXPECT_EQ(plain.body, "let x");
  EXPECT_NE(header(plain, "Cache-Control").find("immutable"), std::string::npos);
  const auto small = get("/assets/app-1a2b.js", {{"accept-encoding", "br, gzip"}});
  EXPECT_EQ(small.body, "compressed");
  EXPECT_EQ(header(small, "Content-Encoding"), "gzip");
  EXPECT_EQ(header(small, "Vary"), "Accept-Encoding");
  EXPECT_EQ(header(get("/assets/app-1a2b.js", {{"accept-encoding", "gzip;q=0"}}), "Content-Encoding"), "");
}

TEST_F(Page, WhatIsKnownIsNotSentAgain) {
  const auto etag = header(get("/"), "ETag");
  EXPECT_EQ(get("/", {{"if-none-match", etag}}).status, 304);
  EXPECT_EQ(get("/", {{"if-none-match", "\"other\""}}).status, 200);
}

TEST_F(Page, NothingElseOfTheMachineIsServed) {
  for (const auto* target : {"/assets/passwd.txt", "/assets/secret.txt", "/secret.txt", "/index.html",
                             "/assets/", "/assets/app-1a2b.js.gz", "/assets/..%2Fsecret.txt"})
    EXPECT_EQ(get(target).status, 404) << target;
}

TEST_F(Page, ADaemonWithoutItSaysSo) {
  router_ = make_routes(cell_, events_, operations_, PageFiles::read(folder_ / "nowhere"));
  const auto notice = get("/");
  EXPECT_EQ(notice.status, 200);
  EXPECT_NE(notice.body.find("was not built"), std::string::npos);
  EXPECT_EQ(get("/assets/app-1a2b.js").status, 404);
}

}  // namespace
}  // namespace calibrd::api
