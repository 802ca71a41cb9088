// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>

#include "server/storage/saved_pose.hpp"
#include "server/storage/sqlite.hpp"
#include "server/storage/store_opening.hpp"
#include "tests/server/storage/scripted_work.hpp"
#include "tests/server/storage/storage_folder.hpp"
#include "tests/server/storage/test_vfs.hpp"

namespace calibrd {
namespace {

/// A store in which "second" is current and "first" was before.
class Recovery : public ::testing::Test {
 protected:
  Recovery() {
    ScriptedWork work(file(), {});
    EXPECT_TRUE(work.add_current("first") && work.add_current("second"));
  }
  std::filesystem::path file() const { return folder_.path() / "cell.db"; }
  std::filesystem::path saved() const { return saved_pose_folder(file()); }
  std::unique_ptr<CalibrationStore> open(const std::string& vfs = {}) const {
    auto store = CalibrationStore::open(file(), vfs);
    EXPECT_TRUE(store) << store.error().message();
    return store ? *std::move(store) : nullptr;
  }
  static std::string current(CalibrationStore& store) {
    const auto found = store.current("kinect2");
    return found && *found ? (*found)->calibration.id : "";
  }
  void overwrite(std::size_t at, std::size_t size, char with) const {
    std::fstream stream(file(), std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(static_cast<std::streamoff>(at));
    stream << std::string(size, with);
  }
  static constexpr std::size_t kPage = 4096;
  /// Pages are counted from 1.
  std::int64_t root_page_of(const std::string& name) const {
    auto database = Database::open(file());
    Statement query(*database, "SELECT rootpage FROM sqlite_schema WHERE name = ?");
    query.bind(name);
    return query.next() ? query.number(0) : 0;
  }
  /// Changes a digit of every stored translation, as a bad disk may: SQLite does not notice.
  void change_a_number() const {
    std::ifstream in(file(), std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const std::string row = "0, 1, 0, 2";
    auto at = bytes.find(row);
    ASSERT_NE(at, std::string::npos);
    for (; at != std::string::npos; at = bytes.find(row, at)) bytes[at + row.size() - 1] = '3';
    std::ofstream(file(), std::ios::binary) << bytes;
  }
  void expect_recovered() const {
    const auto store = open();
    ASSERT_TRUE(store);
    EXPECT_EQ(current(*store), "second");
    EXPECT_EQ((*store->current("kinect2"))->basis, "fx 365");
    EXPECT_EQ((*store->current("kinect2"))->calibration.result->T_base_sensor->translation().y(), 2);
    EXPECT_TRUE(store->report().ready);
    EXPECT_EQ(store->report().state, "recovered");
    const auto aside = find_put_aside(file());
    ASSERT_EQ(aside.size(), 1U) << "the damaged one is kept";
    EXPECT_NE(store->report().reason.find(aside[0].string()), std::string::npos);
    std::filesystem::remove(aside[0]);
    store->look();
    EXPECT_EQ(store->report().state, "good") << "once the damaged one was moved away";
  }

  const StorageFolder folder_;
};

TEST_F(Recovery, ADamagedDatabaseIsPutAsideAndThePoseIsKept) {
  overwrite(4096, 3 * 4096, 'x');
  expect_recovered();
}

TEST_F(Recovery, SoIsOneWhoseHeaderIsGone) {
  overwrite(0, 100, '\0');
  expect_recovered();
}

TEST_F(Recovery, SoIsOneThatTellsAnotherPoseThanTheSavedOne) {
  change_a_number();
  expect_recovered();
}

TEST_F(Recovery, ADatabaseThatIsGoneIsBegunAnewWithThePose) {
  std::filesystem::remove(file());
  const auto store = open();
  EXPECT_EQ(current(*store), "second");
  EXPECT_FALSE((*store->current("kinect2"))->calibration.message.empty()) << "where it comes from";
}

TEST_F(Recovery, DriftIsKnownAfterwards) {
  EXPECT_TRUE(open()->add_drift("second"));
  overwrite(4096, 3 * 4096, 'x');
  EXPECT_TRUE((*open()->current("kinect2"))->drifted);
}

TEST_F(Recovery, ADamagedSavedPoseIsNone) {
  const auto pose = saved() / "kinect2.json";
  std::ifstream in(pose);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.replace(text.find("fx 365"), 6, "fx 364");
  std::ofstream(pose) << text;
  EXPECT_TRUE(read_saved_poses(saved()).empty());
  open();
  EXPECT_EQ(read_saved_poses(saved()).size(), 1U) << "it is written anew from the database";
}

TEST_F(Recovery, WithoutSavedPosesTheDamagedDatabaseIsReadAsFarAsItCanBe) {
  std::filesystem::remove_all(saved());
  const auto page = root_page_of("calibrations_by_key");
  ASSERT_GT(page, 1);
  overwrite(static_cast<std::size_t>(page) * kPage - 100, 100, 'x');
  const auto store = open();
  EXPECT_EQ(current(*store), "second");
}

TEST_F(Recovery, AFileThatWasNeverAStoreIsNotTouched) {
  std::filesystem::remove_all(saved());
  overwrite(0, 100, 'x');
  const auto store = CalibrationStore::open(file());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, StorageError::not_a_store);
  EXPECT_TRUE(find_put_aside(file()).empty());
}

/// Opened while every call of one kind fails, and healed later.
class Hindered : public Recovery, public ::testing::WithParamInterface<std::pair<VfsCall, int>> {};

TEST_P(Hindered, ThePoseIsKnownNothingIsWrittenAndTheStoreIsFoundAgain) {
  TestVfs vfs;
  vfs.fail(GetParam().first, 1, GetParam().second, true);
  const auto store = open(TestVfs::kName);
  ASSERT_TRUE(store);
  EXPECT_EQ(current(*store), "second");
  EXPECT_FALSE(store->report().ready);
  EXPECT_GT(store->report().reason.size(), 40U);
  api::CalibrationReport report;
  report.id = "third";
  report.sensor_id = "kinect2";
  EXPECT_FALSE(store->add(report, {}));
  store->look();
  EXPECT_FALSE(store->report().ready);
  vfs.heal();
  store->look();
  EXPECT_TRUE(store->report().ready) << store->report().reason;
  EXPECT_TRUE(*store->find("first")) << "the history is back";
  EXPECT_TRUE(store->add(report, {}));
  EXPECT_TRUE(find_put_aside(file()).empty());
}

INSTANTIATE_TEST_SUITE_P(Calls, Hindered,
                         ::testing::Values(std::pair{VfsCall::open, SQLITE_CANTOPEN},
                                           std::pair{VfsCall::read, SQLITE_IOERR_READ},
                                           std::pair{VfsCall::shm_map, SQLITE_IOERR_SHMSIZE}));

TEST_F(Recovery, WhatCouldNotBeStoredIsKnownAndStoredOnceThereIsRoom) {
  TestVfs vfs;
  auto store = open(TestVfs::kName);
  api::CalibrationReport report;
  report.id = "third";
  report.sensor_id = "kinect2";
  EXPECT_TRUE(store->add(report, {}));
  vfs.fail(VfsCall::write, 1, SQLITE_FULL, true);
  report.status = api::JobStatus::failed;
  report.finished = std::chrono::system_clock::now();
  report.message = "no room";
  EXPECT_EQ(store->finish(report).error().code, StorageError::full);
  store->owe_end(report);
  EXPECT_FALSE(store->add_drift("second"));
  EXPECT_EQ(store->report().state, "full");
  EXPECT_EQ((*store->find("third"))->message, "no room");
  EXPECT_EQ(store->history({"kinect2", 1, ""})->calibrations.at(0).status, api::JobStatus::failed);
  EXPECT_EQ(current(*store), "second");
  EXPECT_TRUE((*store->current("kinect2"))->drifted);
  vfs.heal();
  store->look();
  EXPECT_TRUE(store->report().ready);
  store.reset();
  store = open();
  EXPECT_EQ((*store->find("third"))->message, "no room");
  EXPECT_TRUE((*store->current("kinect2"))->drifted);
}

TEST_F(Recovery, AnEndThatIsOwedIsNotForgottenForADiskThatFailsOnceMore) {
  TestVfs vfs;
  auto store = open(TestVfs::kName);
  for (int n = 1; n <= 12; ++n) {
    api::CalibrationReport report;
    report.id = "third" + std::to_string(n);
    report.sensor_id = "kinect2";
    ASSERT_TRUE(store->add(report, {}));
    report.status = api::JobStatus::failed;
    report.finished = std::chrono::system_clock::now();
    report.message = "no room";
    vfs.fail(VfsCall::write, 1, SQLITE_FULL, true);
    ASSERT_FALSE(store->finish(report));
    store->owe_end(report);
    vfs.heal();
    vfs.fail(VfsCall::write, n, SQLITE_IOERR_WRITE);
    store->look();
    vfs.heal();
    store->look();
  }
  store.reset();
  store = open();
  for (int n = 1; n <= 12; ++n)
    EXPECT_EQ((*store->find("third" + std::to_string(n)))->message, "no room") << n;
}

TEST_F(Recovery, ASecondCopyThatCannotBeRenewedIsKeptUnlessItIsOfAnotherCalibration) {
  const auto store = open();
  std::filesystem::create_directories(saved() / "kinect2.json.new/in the way");
  EXPECT_TRUE(store->add_drift("second"));
  EXPECT_EQ(store->report().state, "unsaved");
  ASSERT_EQ(read_saved_poses(saved()).size(), 1U);
  EXPECT_EQ(read_saved_poses(saved())[0].calibration_id, "second");
  EXPECT_TRUE(store->activate(**store->find("first"), "fx 365"));
  EXPECT_EQ(store->report().state, "unsaved");
  EXPECT_TRUE(read_saved_poses(saved()).empty());
}

TEST_F(Recovery, ADatabaseFoundDamagedWhileRunningIsReplacedOnlyWhereItIs) {
  TestVfs vfs;
  const auto store = open(TestVfs::kName);
  for (const bool is_damaged : {false, true}) {
    if (is_damaged) {
      (void)integrity_of(file());
      overwrite(4096, 3 * 4096, 'x');
    }
    vfs.fail(VfsCall::shm_lock, 1, SQLITE_CORRUPT);
    const auto generation = store->outbox_generation();
    EXPECT_FALSE(store->history({"kinect2", 10, ""}));
    EXPECT_EQ(store->report().state, "damaged");
    EXPECT_FALSE(store->report().ready);
    store->look();
    EXPECT_EQ(store->report().state, is_damaged ? "recovered" : "good");
    EXPECT_EQ(current(*store), "second");
    EXPECT_EQ(store->find("first")->has_value(), !is_damaged);
    EXPECT_NE(store->outbox_generation(), generation) << "the outbox's numbers may begin anew";
  }
}

}  // namespace
}  // namespace calibrd
