// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/calibration_store.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <fstream>

#include "server/storage/background_text.hpp"

namespace calibrd {
namespace {

using api::CalibrationReport;
using api::JobStatus;

class Store : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("calibrd_store_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    open();
  }
  void TearDown() override {
    store_.reset();
    std::filesystem::remove_all(folder_);
  }
  std::filesystem::path file() const { return folder_ / "deep" / "cell.db"; }
  void open() {
    store_.reset();
    auto opened = CalibrationStore::open(file());
    ASSERT_TRUE(opened) << opened.error().message();
    store_ = *std::move(opened);
  }

  CalibrationReport add(const std::string& id, const std::string& key = {}) {
    CalibrationReport report;
    report.id = id;
    report.sensor_id = "kinect2";
    report.created = std::chrono::system_clock::now();
    report.postures_wanted = 3;
    api::CalibrationRequest request;
    request.idempotency_key = key;
    request.fingerprint = "{}";
    EXPECT_TRUE(store_->add(report, request));
    return report;
  }
  void finish(CalibrationReport report, Verdict verdict = Verdict::accepted) {
    CalibrationResult result;
    result.verdict = verdict;
    result.T_base_sensor = Pose(Eigen::Translation3d(1, 2, 3));
    report.result = result;
    report.status = verdict == Verdict::accepted ? JobStatus::succeeded : JobStatus::failed;
    report.finished = std::chrono::system_clock::now();
    EXPECT_TRUE(store_->finish(report));
  }
  /// What SQLite says to statements that no daemon would run.
  std::string run_raw(const std::string& sql) {
    sqlite3* connection = nullptr;
    sqlite3_open(file().c_str(), &connection);
    sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr);
    std::string words = sqlite3_errmsg(connection);
    sqlite3_close(connection);
    return words;
  }

  std::filesystem::path folder_;
  std::unique_ptr<CalibrationStore> store_;
};

TEST_F(Store, KeepsAResultAcrossARestart) {
  finish(add("c1"));
  open();
  const auto found = store_->find("c1");
  ASSERT_TRUE(found && *found);
  EXPECT_EQ((*found)->status, JobStatus::succeeded);
  ASSERT_TRUE((*found)->result);
  EXPECT_DOUBLE_EQ((*found)->result->T_base_sensor->translation().z(), 3);
  EXPECT_FALSE((*found)->current);
  EXPECT_FALSE(*store_->find("c2"));
}

TEST_F(Store, TheLastActivatedIsCurrentAndAnEarlierOneCanBeAgain) {
  const auto first = add("c1"), second = add("c2");
  finish(first);
  finish(second);
  EXPECT_FALSE(*store_->current("kinect2"));
  EXPECT_TRUE(store_->activate(first, "fx 365"));
  EXPECT_TRUE(store_->activate(second, "fx 366"));
  EXPECT_EQ((*store_->current("kinect2"))->calibration.id, "c2");
  EXPECT_TRUE(store_->activate(first, "fx 365"));
  open();
  EXPECT_EQ((*store_->current("kinect2"))->calibration.id, "c1");
  EXPECT_TRUE((*store_->find("c1"))->current);
  EXPECT_FALSE((*store_->find("c2"))->current);
  EXPECT_EQ((*store_->current("kinect2"))->basis, "fx 365");
  EXPECT_FALSE(*store_->current("other"));
}

TEST_F(Store, DriftIsKeptUntilTheCalibrationIsActivatedAgain) {
  const auto first = add("c1"), second = add("c2");
  finish(first);
  finish(second);
  EXPECT_TRUE(store_->activate(first, ""));
  EXPECT_TRUE(store_->add_drift("c2")) << "not current: nothing to record";
  EXPECT_FALSE((*store_->current("kinect2"))->drifted);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(store_->add_drift("c1"));
  open();
  EXPECT_TRUE((*store_->current("kinect2"))->drifted);
  EXPECT_TRUE(store_->activate(first, ""));
  EXPECT_FALSE((*store_->current("kinect2"))->drifted);
  EXPECT_EQ(run_raw("DELETE FROM drifts"), "drifts are kept");
}

TEST_F(Store, BackgroundOutlivesARestartAndTheFirstStays) {
  finish(add("c1"));
  EXPECT_TRUE(store_->add_background("c1", {0, 1.2345F, 6.5F, 7.0F}));
  EXPECT_TRUE(store_->add_background("c1", {3, 3, 3, 3}));
  open();
  const auto kept = store_->background("c1");
  ASSERT_TRUE(kept && *kept);
  ASSERT_EQ((*kept)->size(), 4U);
  EXPECT_EQ((*kept)->at(0), 0);
  EXPECT_NEAR((*kept)->at(1), 1.2345, 1e-5);
  EXPECT_NEAR((*kept)->at(2), 6.5, 1e-5);
  EXPECT_EQ((*kept)->at(3), 0) << "too far to be kept";
  EXPECT_FALSE(*store_->background("c2"));
  EXPECT_EQ(run_raw("DELETE FROM backgrounds"), "backgrounds are kept");
}

TEST_F(Store, OfBackgroundsTheNewestAndThatOfTheCurrentPoseAreKept) {
  const auto name = [](int i) { return "c" + std::to_string(i); };
  const auto has = [&](const std::string& id) { return store_->background(id)->has_value(); };
  for (int i = 0; i < 205; ++i) {
    const auto calibration = add(name(i));
    finish(calibration);
    EXPECT_TRUE(store_->add_background(name(i), {1, 2, 3}));
    if (i == 1) {
      EXPECT_TRUE(store_->activate(calibration, ""));
    }
  }
  for (int i = 0; i < 205; ++i) EXPECT_EQ(has(name(i)), i == 1 || i >= 5) << i;
  EXPECT_EQ(store_->history({"kinect2", 500, ""})->calibrations.size(), 205U);
  EXPECT_EQ(run_raw("DELETE FROM backgrounds WHERE calibration_id = 'c5'"), "backgrounds are kept");
}

TEST(BackgroundText, DamageIsNoBackground) {
  EXPECT_EQ(background_text({0.0001F, 0}), "00010000");
  for (const char* damaged : {"000", "00g0", "-001", "0x10"})
    EXPECT_FALSE(parse_background(damaged)) << damaged;
}

TEST_F(Store, EvidenceIsKeptWithTheEnd) {
  auto report = add("c1");
  report.evidence =
      api::Evidence{"0.1.0", "[server]\nport = 1\n", {"s", "l"}, {{12.5, {0.1, -2}}, {13, {0.2, 3}}}};
  finish(report);
  open();
  const auto evidence = (*store_->find("c1"))->evidence;
  ASSERT_TRUE(evidence);
  EXPECT_EQ(evidence->software_version, "0.1.0");
  EXPECT_EQ(evidence->configuration, "[server]\nport = 1\n");
  EXPECT_EQ(evidence->joint_names, (std::vector<std::string>{"s", "l"}));
  ASSERT_EQ(evidence->views.size(), 2U);
  EXPECT_EQ(evidence->views[0].stamp_s, 12.5);
  EXPECT_EQ(evidence->views[1].joint_positions_rad, (std::vector<double>{0.2, 3}));
  EXPECT_EQ(run_raw("DELETE FROM evidence"), "evidence is kept");
}

TEST_F(Store, ResultsCannotBeChangedOrDeleted) {
  finish(add("c1"));
  EXPECT_EQ(run_raw("UPDATE results SET status = 'failed'"), "results are kept");
  EXPECT_EQ(run_raw("DELETE FROM results"), "results are kept");
  EXPECT_EQ(run_raw("DELETE FROM calibrations"), "calibrations are kept");
  EXPECT_EQ((*store_->find("c1"))->status, JobStatus::succeeded);
}

TEST_F(Store, ASecondEndOfACalibrationIsRefused) {
  const auto report = add("c1");
  finish(report);
  EXPECT_FALSE(store_->finish(report));
}

TEST_F(Store, CalibrationUnderWayWhenTheDaemonEndedHasFailed) {
  add("c1");
  EXPECT_EQ((*store_->find("c1"))->status, JobStatus::queued);
  open();
  const auto found = *store_->find("c1");
  EXPECT_EQ(found->status, JobStatus::failed);
  EXPECT_NE(found->message.find("daemon ended"), std::string::npos);
}

TEST_F(Store, HistoryIsNewestFirstAndPaged) {
  for (const auto* id : {"c1", "c2", "c3"}) finish(add(id));
  const auto first = store_->history({"kinect2", 2, ""});
  ASSERT_TRUE(first);
  ASSERT_EQ(first->calibrations.size(), 2U);
  EXPECT_EQ(first->calibrations[0].id, "c3");
  EXPECT_TRUE(first->more);
  const auto second = store_->history({"kinect2", 2, "c2"});
  ASSERT_EQ(second->calibrations.size(), 1U);
  EXPECT_EQ(second->calibrations[0].id, "c1");
  EXPECT_FALSE(second->more);
  EXPECT_TRUE(store_->history({"other", 2, ""})->calibrations.empty());
}

TEST_F(Store, FindsWhatAnIdempotencyKeyStarted) {
  add("c1", "key-1");
  open();
  const auto start = store_->find_start("kinect2", "key-1");
  ASSERT_TRUE(start && *start);
  EXPECT_EQ((*start)->calibration_id, "c1");
  EXPECT_EQ((*start)->fingerprint, "{}");
  EXPECT_FALSE(*store_->find_start("kinect2", "key-2"));
  EXPECT_FALSE(*store_->find_start("other", "key-1"));
}

TEST_F(Store, WritesAreSyncedToTheDisk) { EXPECT_TRUE(std::filesystem::exists(file().string() + "-wal")); }

TEST_F(Store, FileThatIsNoStoreIsRefused) {
  const auto other = folder_ / "notes.txt";
  std::ofstream(other) << std::string(5000, 'x');
  const auto opened = CalibrationStore::open(other);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, StorageError::not_a_store);
  EXPECT_NE(opened.error().message().find("notes.txt"), std::string::npos);
}

TEST_F(Store, FolderThatCannotBeMadeIsNamed) {
  std::ofstream(folder_ / "file") << "x";
  const auto opened = CalibrationStore::open(folder_ / "file" / "cell.db");
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, StorageError::cannot_open);
}

TEST_F(Store, StoreOfANewerVersionIsRefused) {
  run_raw("PRAGMA user_version = 99");
  store_.reset();
  const auto opened = CalibrationStore::open(file());
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, StorageError::newer_schema);
}

TEST_F(Store, BelongsToOneProcessAtATime) {
  add("under way");
  const auto link = folder_ / "link.db";
  std::filesystem::create_symlink(file(), link);
  for (const auto& name : {file(), link}) {
    const auto second = CalibrationStore::open(name);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, StorageError::in_use);
    EXPECT_NE(second.error().message().find("storage.path"), std::string::npos);
  }
  EXPECT_FALSE((**store_->find("under way")).finished) << "the second daemon ended it";
}

}  // namespace
}  // namespace calibrd
