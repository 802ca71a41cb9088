// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/capture_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/storage/storage_folder.hpp"

namespace calibrd {
namespace {

using std::chrono::hours;

class Captures : public ::testing::Test {
 protected:
  void make_older(const std::string& id, hours age) const {
    const auto file = folder_.path() / (id + ".tar");
    std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) - age);
  }
  const StorageFolder folder_;
};

TEST_F(Captures, AreReadBackUntilTheyAreTooOld) {
  CaptureFolder captures(folder_.path(), {hours(2), 1000});
  EXPECT_TRUE(captures.keep("a", "views of a"));
  EXPECT_TRUE(captures.keep("b", "views of b"));
  make_older("a", hours(3));
  make_older("b", hours(1));
  EXPECT_EQ(*captures.read("a"), "views of a");
  captures.remove_old();
  EXPECT_FALSE(captures.size("a"));
  EXPECT_FALSE(captures.read("a"));
  EXPECT_EQ(captures.size("b"), 10U);
}

TEST_F(Captures, WhatAnEarlierDaemonWasMakingIsRemovedAndWhatIsKeptStays) {
  const CaptureFolder earlier(folder_.path(), {});
  std::filesystem::create_directories(earlier.scratch() / "capture.x/half done");
  std::ofstream(folder_.path() / "a.tar") << "views of a";
  const CaptureFolder captures(folder_.path(), {});
  EXPECT_FALSE(std::filesystem::exists(captures.scratch()));
  EXPECT_EQ(captures.size("a"), 10U);
}

TEST_F(Captures, TheOldestMakeRoom) {
  CaptureFolder captures(folder_.path(), {hours(24), 250});
  for (const char* id : {"a", "b"}) EXPECT_TRUE(captures.keep(id, std::string(100, 'x')));
  make_older("b", hours(2));
  EXPECT_TRUE(captures.keep("c", std::string(100, 'x')));
  EXPECT_FALSE(captures.size("b"));
  EXPECT_TRUE(captures.size("a") && captures.size("c"));
  EXPECT_TRUE(captures.keep("too large", std::string(300, 'x')));
  EXPECT_FALSE(captures.size("too large"));
  EXPECT_TRUE(captures.size("a") && captures.size("c")) << "nothing made room for what cannot be kept";
}

TEST_F(Captures, NoneAreKeptWhereTheConfigurationSaysSo) {
  for (const CaptureLimits limits : {CaptureLimits{hours(0), 1000}, CaptureLimits{hours(2), 0}}) {
    CaptureFolder captures(folder_.path() / "none", limits);
    EXPECT_FALSE(captures.keeps_any());
    EXPECT_TRUE(captures.keep("a", "x"));
    EXPECT_FALSE(captures.size("a"));
  }
}

TEST_F(Captures, WhatACrashLeftHalfWrittenGoesWithAge) {
  CaptureFolder captures(folder_.path(), {hours(2), 1000});
  std::ofstream(folder_.path() / "a.tar.new") << "half";
  std::ofstream(folder_.path() / "notes.txt") << "not ours";
  for (const char* name : {"a.tar.new", "notes.txt"}) {
    const auto file = folder_.path() / name;
    std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) - hours(3));
  }
  captures.remove_old();
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "a.tar.new"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "notes.txt"));
}

}  // namespace
}  // namespace calibrd
