// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <sstream>

#include "server/security/security_error.hpp"
#include "server/security/token_store.hpp"
#include "tests/server/security/folder.hpp"

namespace calibrd {
namespace {

using api::Scope;

class Tokens : public ::testing::Test {
 protected:
  std::string text() const {
    std::stringstream content;
    content << std::ifstream(file_).rdbuf();
    return content.str();
  }
  std::string create(const std::string& name, Scope scope = Scope::read) {
    const auto token = create_token(file_, name, scope);
    if (!token) throw std::runtime_error(token.error().message());
    return *token;
  }

  const Folder folder_;
  const std::filesystem::path file_ = folder_.path / "tokens.json";
};

TEST_F(Tokens, EachHas256RandomBitsAndIsLikeNoOther) {
  std::set<std::string> all;
  for (int i = 0; i < 100; ++i) {
    const auto token = new_token();
    ASSERT_TRUE(token);
    EXPECT_EQ(token->size(), 8U + 43U);  // 43 characters of six bits
    EXPECT_TRUE(all.insert(*token).second);
  }
}

TEST(TokenDigest, IsSha256) {
  EXPECT_EQ(hex_text(digest_of("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_TRUE(is_same(*digest_of_hex(hex_text(digest_of("abc"))), digest_of("abc")));
  EXPECT_FALSE(is_same(digest_of("abc"), digest_of("abd")));
}

TEST_F(Tokens, TheFileHoldsNoTokenAndIsItsOwnersAlone) {
  const auto token = create("hmi", Scope::calibrate);
  EXPECT_EQ(text().find(token.substr(8)), std::string::npos);
  EXPECT_NE(text().find(hex_text(digest_of(token))), std::string::npos);
  struct stat seen {};
  ASSERT_EQ(::stat(file_.c_str(), &seen), 0);
  EXPECT_EQ(seen.st_mode & 0777U, 0600U);
}

TEST_F(Tokens, AreFoundByWhatTheyAreUntilRevoked) {
  const auto hmi = create("hmi", Scope::calibrate), page = create("page");
  const auto store = TokenStore::open(file_);
  ASSERT_TRUE(store) << store.error().message();
  EXPECT_EQ((*store)->find(hmi)->name, "hmi");
  EXPECT_EQ((*store)->find(hmi)->scope, Scope::calibrate);
  EXPECT_EQ((*store)->find(page)->scope, Scope::read);
  EXPECT_FALSE((*store)->find(hmi + "x"));
  EXPECT_FALSE((*store)->find(""));
  EXPECT_FALSE((*store)->find(hex_text(digest_of(hmi)))) << "the stored hash is no token";
  ASSERT_TRUE(revoke_token(file_, "hmi"));
  (*store)->refresh();
  EXPECT_FALSE((*store)->find(hmi));
  EXPECT_TRUE((*store)->find(page));
  EXPECT_EQ(revoke_token(file_, "hmi").error().code, SecurityError::no_such_token);
}

TEST_F(Tokens, NamesAreTakenOnceAndPlain) {
  create("hmi");
  EXPECT_EQ(create_token(file_, "hmi", Scope::read).error().code, SecurityError::token_exists);
  for (const auto* name : {"", "local", "a b", "a\nb", "a/b", "\xc3\xa4"})
    EXPECT_EQ(create_token(file_, name, Scope::read).error().code, SecurityError::bad_token_name) << name;
}

TEST_F(Tokens, AFileOthersMayReadIsRefused) {
  create("hmi");
  ASSERT_EQ(::chmod(file_.c_str(), 0640), 0);
  EXPECT_EQ(TokenStore::open(file_).error().code, SecurityError::tokens_open_to_others);
}

TEST_F(Tokens, ADamagedFileIsRefusedAtTheStartAndChangesNothingLater) {
  const auto token = create("hmi");
  std::string said;
  const auto store = TokenStore::open(file_, [&](const std::string& message, bool) { said = message; });
  ASSERT_TRUE(store);
  std::ofstream(file_) << "{\"format\": ";
  (*store)->refresh();
  EXPECT_TRUE((*store)->find(token));
  EXPECT_NE(said.find("stay as they were"), std::string::npos) << said;
  for (const auto* wrong :
       {"", "[]", "{}", R"({"format":"calibrd-tokens/1"})", R"({"format":"calibrd-tokens/1","tokens":[1]})",
        R"({"format":"calibrd-tokens/1","tokens":[{"name":"a","scope":"root","sha256":""}]})"}) {
    std::ofstream(file_) << wrong;
    EXPECT_EQ(read_tokens(file_).error().code, SecurityError::tokens_malformed) << wrong;
  }
}

TEST_F(Tokens, WithoutAFileThereAreNone) {
  std::string said;
  const auto store = TokenStore::open(file_, [&](const std::string& message, bool) { said = message; });
  ASSERT_TRUE(store);
  EXPECT_EQ((*store)->size(), 0U);
  EXPECT_NE(said.find("token create"), std::string::npos);
  create("hmi");
  (*store)->refresh();
  EXPECT_EQ((*store)->size(), 1U);
  std::filesystem::remove(file_);
  (*store)->refresh();
  EXPECT_EQ((*store)->size(), 0U);
}

TEST_F(Tokens, WhatChangesInTheFileIsTold) {
  create("old");
  std::vector<std::pair<std::string, bool>> told;
  const auto store = TokenStore::open(
      file_, {}, [&](const std::string& what, bool is_done) { told.emplace_back(what, is_done); });
  ASSERT_TRUE(store);
  create("hmi", Scope::calibrate);
  ASSERT_TRUE(revoke_token(file_, "old"));
  (*store)->refresh();
  (*store)->refresh();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0], std::pair(std::string("made hmi (calibrate), revoked old (read)"), true));
  std::ofstream(file_) << "{";
  (*store)->refresh();
  ASSERT_EQ(told.size(), 2U);
  EXPECT_FALSE(told[1].second);
}

TEST_F(Tokens, AFolderThatIsNotThereIsNamed) {
  const auto made = create_token(folder_.path / "none/tokens.json", "hmi", Scope::read);
  EXPECT_EQ(made.error().code, SecurityError::tokens_not_written);
  EXPECT_NE(made.error().message().find("none"), std::string::npos);
}

}  // namespace
}  // namespace calibrd
