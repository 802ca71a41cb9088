// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/server/storage/scripted_work.hpp"
#include "tests/server/storage/storage_folder.hpp"
#include "tests/server/storage/test_vfs.hpp"

namespace calibrd {
namespace {

/// The power fails before this change of the disk; what is left is opened as after a restart.
struct Cut {
  int change;
  double kept;
  unsigned seed;
};

/// Nothing for a cut after the end of the work.
std::optional<std::vector<std::string>> broken_by(const Cut& cut, const StorageFolder& folder) {
  folder.clear();
  std::filesystem::create_directories(folder.path() / "after");
  TestVfs vfs;
  vfs.cut_power(cut.change);
  ScriptedWork work(folder.path() / "cell.db", TestVfs::kName);
  work.run();
  work.close();
  if (!vfs.is_off()) return std::nullopt;
  std::mt19937 random(cut.seed);
  vfs.disk().write_remains(folder.path() / "after", cut.kept, random);
  auto broken = work.broken_promises(folder.path() / "after" / "cell.db");
  if (const auto words = integrity_of(folder.path() / "after" / "cell.db"); words != "ok")
    broken.push_back("the database is intact: " + words);
  return broken;
}

TEST(PowerLoss, WhatWasReportedAsStoredIsThereWhereverThePowerFails) {
  const StorageFolder folder;
  int cuts = 0;
  for (bool is_on = false; !is_on;) {
    ++cuts;
    // Everything or nothing of what was not synced, and four times some of it.
    for (const auto& [kept, seed] :
         {std::pair{0.0, 0U}, {1.0, 0U}, {0.5, 1U}, {0.5, 2U}, {0.2, 3U}, {0.8, 4U}}) {
      const auto broken = broken_by({cuts, kept, seed}, folder);
      is_on = !broken;
      if (is_on) break;
      for (const auto& promise : *broken)
        ADD_FAILURE() << "before change " << cuts << ", " << kept << " kept, seed " << seed
                      << ", it does not hold that " << promise;
    }
    ASSERT_FALSE(HasFailure()) << "at the first of the cuts that lose something";
  }
  EXPECT_GT(cuts, 100);
  RecordProperty("cuts", cuts);
}

}  // namespace
}  // namespace calibrd
