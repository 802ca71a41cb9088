// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/server/storage/scripted_work.hpp"
#include "tests/server/storage/storage_folder.hpp"
#include "tests/server/storage/test_vfs.hpp"

namespace calibrd {
namespace {

struct Fault {
  VfsCall call;
  int code;
  bool for_good;  ///< until the test heals it, as a full disk stays full
};

void expect_clear(const std::vector<Error>& errors) {
  for (const Error& error : errors) {
    EXPECT_EQ(&error.code.category(), &storage_category()) << error.message();
    EXPECT_GT(error.message().size(), 30U);
    const bool was_memory = error.code == StorageError::out_of_memory;
    EXPECT_TRUE(was_memory || !error.detail.empty()) << error.message();
  }
}

/// The n-th call of its kind fails; false: there are not that many.
bool survives(const Fault& fault, int n, const StorageFolder& folder) {
  folder.clear();
  const auto file = folder.path() / "cell.db";
  TestVfs vfs;
  vfs.fail(fault.call, n, fault.code, fault.for_good);
  ScriptedWork work(file, TestVfs::kName);
  work.run();
  const bool has_failed = vfs.has_failed();
  vfs.heal();
  EXPECT_TRUE(work.add_current("after the fault")) << "the store goes on";
  work.close();
  for (const auto& promise : work.broken_promises(file)) ADD_FAILURE() << "it does not hold that " << promise;
  EXPECT_EQ(integrity_of(file), "ok");
  expect_clear(work.errors());
  return has_failed;
}

class SystemCalls : public ::testing::TestWithParam<Fault> {};

TEST_P(SystemCalls, EachMayFailAndNothingReportedIsLost) {
  const StorageFolder folder;
  int n = 1;
  while (survives(GetParam(), n, folder)) {
    ASSERT_FALSE(HasFailure()) << "call number " << n;
    ++n;
  }
  EXPECT_GT(n, 2) << "there was nothing to fail";
  RecordProperty("calls", n - 1);
}

INSTANTIATE_TEST_SUITE_P(One, SystemCalls,
                         ::testing::Values(Fault{VfsCall::open, SQLITE_CANTOPEN, false},
                                           Fault{VfsCall::read, SQLITE_IOERR_READ, false},
                                           Fault{VfsCall::write, SQLITE_IOERR_WRITE, false},
                                           Fault{VfsCall::write, SQLITE_FULL, false},
                                           Fault{VfsCall::truncate, SQLITE_IOERR_TRUNCATE, false},
                                           Fault{VfsCall::sync, SQLITE_IOERR_FSYNC, false},
                                           Fault{VfsCall::remove, SQLITE_IOERR_DELETE, false},
                                           Fault{VfsCall::size, SQLITE_IOERR_FSTAT, false},
                                           Fault{VfsCall::lock, SQLITE_IOERR_LOCK, false},
                                           Fault{VfsCall::shm_map, SQLITE_IOERR_SHMMAP, false},
                                           Fault{VfsCall::shm_lock, SQLITE_IOERR_SHMLOCK, false}),
                         [](const auto& info) {
                           return name_of(info.param.call) + std::to_string(info.param.code);
                         });

INSTANTIATE_TEST_SUITE_P(FromThenOn, SystemCalls,
                         ::testing::Values(Fault{VfsCall::write, SQLITE_FULL, true},
                                           Fault{VfsCall::write, SQLITE_READONLY, true},
                                           Fault{VfsCall::sync, SQLITE_IOERR_FSYNC, true},
                                           Fault{VfsCall::read, SQLITE_IOERR_READ, true},
                                           Fault{VfsCall::shm_map, SQLITE_IOERR_SHMSIZE, true}),
                         [](const auto& info) {
                           return name_of(info.param.call) + std::to_string(info.param.code);
                         });

}  // namespace
}  // namespace calibrd
