// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/schema.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "api/json/calibration_result_json.hpp"
#include "server/storage/calibration_store.hpp"
#include "tests/server/storage/storage_folder.hpp"

namespace calibrd {
namespace {

constexpr const char* kRowsOfOne =
    "INSERT INTO calibrations (id, sensor_id, created_ms, method, postures, activate, idempotency_key, "
    "fingerprint) VALUES ('old', 'kinect2', 1000, 'full', 3, 1, 'key', '{}'), "
    "('older', 'kinect2', 500, 'paper', 4, 0, NULL, '{}');"
    "INSERT INTO results VALUES ('old', 2000, 'succeeded', '', 3, 'RESULT'), ('older', 700, 'failed', "
    "'rejected', 4, NULL);"
    "INSERT INTO activations (sensor_id, calibration_id, activated_ms) VALUES ('kinect2', 'old', 3000);";
constexpr const char* kRowsOfTwo =
    "INSERT INTO activations (sensor_id, calibration_id, activated_ms, basis) "
    "VALUES ('kinect2', 'old', 4000, 'fx 365');"
    "INSERT INTO drifts VALUES (2, 5000);";
constexpr const char* kRowsOfThree = "INSERT INTO backgrounds VALUES ('old', '3039');";

/// A store as the version with so many steps left it.
class OlderSchema : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    std::string sql;
    for (int step = 0; step < GetParam(); ++step) sql += kSchemaSteps.at(static_cast<std::size_t>(step));
    CalibrationResult result;
    result.verdict = Verdict::accepted;
    result.T_base_sensor = Pose(Eigen::Translation3d(1, 2, 3));
    const std::string rows = kRowsOfOne;
    const auto at = rows.find("RESULT");
    sql += rows.substr(0, at) + api::calibration_result_json(result) + rows.substr(at + 6);
    if (GetParam() >= 2) sql += kRowsOfTwo;
    if (GetParam() >= 3) sql += kRowsOfThree;
    sql += "PRAGMA user_version = " + std::to_string(GetParam());
    sqlite3* connection = nullptr;
    sqlite3_open(file().c_str(), &connection);
    ASSERT_EQ(sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(connection);
    sqlite3_close(connection);
  }
  std::filesystem::path file() const { return folder_.path() / "cell.db"; }

  const StorageFolder folder_;
};

TEST_P(OlderSchema, IsBroughtUpToDateAndKeepsEverything) {
  for (int i = 0; i < 2; ++i) {  // the second time it is up to date
    const auto store = CalibrationStore::open(file());
    ASSERT_TRUE(store) << store.error().message();
    EXPECT_EQ((*store)->report().state, "good");
    const auto current = (*store)->current("kinect2");
    ASSERT_TRUE(current && *current);
    EXPECT_EQ((*current)->calibration.id, "old");
    EXPECT_EQ((*current)->calibration.result->T_base_sensor->translation().z(), 3);
    EXPECT_EQ((*current)->basis, GetParam() >= 2 ? "fx 365" : "");
    EXPECT_EQ((*current)->drifted, GetParam() >= 2);
    const auto background = (*store)->background("old");
    ASSERT_EQ(background->has_value(), GetParam() >= 3);
    if (GetParam() >= 3) {
      EXPECT_NEAR((*background)->at(0), 1.2345, 1e-5);
    }
    const auto older = *(*store)->find("older");
    EXPECT_EQ(older->message, "rejected");
    EXPECT_EQ(older->method, Method::paper);
    EXPECT_FALSE(older->evidence);
    EXPECT_EQ((*(*store)->find_start("kinect2", "key"))->calibration_id, "old");
    EXPECT_EQ((*store)->history({"kinect2", 10, ""})->calibrations.size(), 2U);
  }
}

INSTANTIATE_TEST_SUITE_P(Versions, OlderSchema,
                         ::testing::Range(1, static_cast<int>(kSchemaSteps.size()) + 1));

}  // namespace
}  // namespace calibrd
