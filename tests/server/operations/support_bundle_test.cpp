// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/support_bundle.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace calibrd {
namespace {

TEST(SupportBundle, LeavesSecretsOfTheConfigurationOut) {
  const auto text = without_secrets(
      "[server]\naddress = \"127.0.0.1\"\ntls_key = \"s1\"\nTokens = [\"s2\"]  # "
      "/etc/calibrd.toml:3\n[auth]\n"
      "password = \"s3\"\nport = 8080\n");
  EXPECT_EQ(text,
            "[server]\naddress = \"127.0.0.1\"\ntls_key = \"(left out)\"\nTokens = \"(left out)\"\n[auth]\n"
            "password = \"(left out)\"\nport = 8080\n");
}

TEST(SupportBundle, HoldsItsFilesAndSaysWhatTheyAre) {
  const auto bundle =
      bundle_of({{"a.txt", "alpha"}, {"empty.txt", ""}, {std::string(300, 'x'), "too long a name"}}, {});
  EXPECT_EQ(bundle.file_name, "calibrd-support-19700101T000000Z.tar");
  EXPECT_NE(bundle.tar.find("calibrd-support-19700101T000000Z/a.txt"), std::string::npos);
  EXPECT_NE(bundle.tar.find("alpha"), std::string::npos);
  EXPECT_NE(bundle.tar.find("left out, its name is too long"), std::string::npos);
  EXPECT_EQ(bundle.tar.find("empty.txt"), std::string::npos);
}

TEST(SupportBundle, TakesWholeLinesFromTheEndOfAFile) {
  const auto file = std::filesystem::temp_directory_path() / ("calibrd_end_" + std::to_string(getpid()));
  std::ofstream(file) << "first\nsecond\nthird\n";
  EXPECT_EQ(end_of_file(file, 1000), "first\nsecond\nthird\n");
  EXPECT_EQ(end_of_file(file, 15), "second\nthird\n");
  EXPECT_EQ(end_of_file(file, 9), "third\n");
  std::filesystem::remove(file);
  EXPECT_EQ(end_of_file(file, 9), "");
}

TEST(SupportBundle, ListsTheNewestFilesOfAFolder) {
  const auto folder = std::filesystem::temp_directory_path() / ("calibrd_list_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "old") << "12345";
  std::ofstream(folder / "new") << "1";
  const auto now = std::filesystem::file_time_type::clock::now();
  std::filesystem::last_write_time(folder / "old", now - std::chrono::hours(1));
  const auto list = list_of_files(folder, 1);
  EXPECT_NE(list.find(": 2 files\n"), std::string::npos) << list;
  EXPECT_NE(list.find(" 1 new\n"), std::string::npos) << list;
  EXPECT_EQ(list.find("old"), std::string::npos) << list;
  std::filesystem::remove_all(folder);
  EXPECT_NE(list_of_files(folder, 1).find(": 0 files"), std::string::npos);
}

TEST(SupportBundle, BringsTheNewestCapturesAsFarAsThereIsRoom) {
  const auto folder = std::filesystem::temp_directory_path() / ("calibrd_views_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / ".making");
  const auto now = std::filesystem::file_time_type::clock::now();
  int age = 0;
  for (const auto* name : {"newest.tar", "newer.tar", "old.tar"}) {
    std::ofstream(folder / name) << "12345";
    std::filesystem::last_write_time(folder / name, now - std::chrono::hours(age++));
  }
  const BundleFiles both{{"captures/newest.tar", "12345"}, {"captures/newer.tar", "12345"}};
  EXPECT_EQ(newest_captures(folder, 14), both);
  EXPECT_TRUE(newest_captures(folder, 4).empty());
  std::filesystem::remove_all(folder);
  EXPECT_TRUE(newest_captures(folder).empty());
}

}  // namespace
}  // namespace calibrd
