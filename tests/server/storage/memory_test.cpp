// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/server/storage/allocation_faults.hpp"
#include "tests/server/storage/scripted_work.hpp"
#include "tests/server/storage/storage_folder.hpp"

namespace calibrd {
namespace {

constexpr int kEvery = 7;  // of some ten thousand; prime, so that another run of the script meets others

/// The n-th allocation of the store's calls fails; false: there are not that many.
bool survives(int n, const StorageFolder& folder) {
  folder.clear();
  const auto file = folder.path() / "cell.db";
  ScriptedWork work(file, {});
  AllocationsCount::fail(n);
  work.run();
  const bool has_failed = AllocationsCount::has_failed();
  AllocationsCount::fail(0);
  EXPECT_TRUE(work.add_current("after the fault")) << "the store goes on";
  work.close();
  for (const auto& promise : work.broken_promises(file)) ADD_FAILURE() << "it does not hold that " << promise;
  EXPECT_EQ(integrity_of(file), "ok");
  for (const Error& error : work.errors())
    EXPECT_EQ(&error.code.category(), &storage_category()) << error.message();
  return has_failed;
}

void expect_survival() {
  const StorageFolder folder;
  int n = 1;
  while (survives(n, folder)) {
    ASSERT_FALSE(::testing::Test::HasFailure()) << "allocation number " << n;
    n += n < 500 ? 1 : kEvery;
  }
  EXPECT_GT(n, 1000) << "there was nothing to fail";
}

TEST(Memory, EachAllocationMayFailAndNothingReportedIsLost) { expect_survival(); }

TEST(Memory, EachAllocationOfSqliteMayFailToo) {
  AllocationsCount::hook_sqlite();
  expect_survival();
}

}  // namespace
}  // namespace calibrd
