// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/pose_json.hpp"

#include <gtest/gtest.h>

#include "core/capture/capture_error.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd {
namespace {

using test::ScratchFolder;

/// A quarter turn about z, then 1, 2, 3 m: the sensor's x axis is base y.
constexpr const char* kQuarterTurn =
    R"({"T_base_sensor": [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]})";

void expect_quarter_turn(const Result<Pose>& pose) {
  ASSERT_TRUE(pose) << pose.error().message();
  EXPECT_LT((*pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-9);
  EXPECT_LT((*pose * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(0, 2, 3)).norm(), 1e-9);
  EXPECT_LT((*pose * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1, 2, 4)).norm(), 1e-9);
}

Error refused(const std::string& json) {
  const auto pose = parse_pose_json(json, "guess.json");
  if (pose) {
    ADD_FAILURE() << "was read: " << json;
    return {};
  }
  EXPECT_EQ(pose.error().code, make_error_code(CaptureError::bad_pose_file));
  EXPECT_NE(pose.error().detail.find("guess.json"), std::string::npos);
  return pose.error();
}

TEST(PoseJson, ReadsFourByFour) { expect_quarter_turn(parse_pose_json(kQuarterTurn, "")); }

TEST(PoseJson, ReadsThreeByFour) {
  expect_quarter_turn(
      parse_pose_json(R"({"T_base_sensor": [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]]})", ""));
}

TEST(PoseJson, ReadsTwelveNumbersRowByRow) {
  expect_quarter_turn(parse_pose_json(R"({"T_base_sensor": [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3]})", ""));
}

TEST(PoseJson, ReadsSixteenNumbersRowByRow) {
  expect_quarter_turn(
      parse_pose_json(R"({"T_base_sensor": [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]})", ""));
}

TEST(PoseJson, IgnoresOtherKeys) {
  expect_quarter_turn(parse_pose_json(
      R"({"verdict": "accepted", "T_base_sensor": [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]], "views": 3})",
      ""));
}

TEST(PoseJson, ReadsAFileByItsName) {
  const ScratchFolder folder;
  expect_quarter_turn(read_pose(folder.write("guess.json", kQuarterTurn).string()));
}

TEST(PoseJson, ReadsPositionThenQuaternionWithItsRealPartLast) {
  expect_quarter_turn(read_pose("1,2,3,0,0,0.70710678118654752,0.70710678118654752"));
  expect_quarter_turn(read_pose(" 1, +2.0 ,3e0,\t-0,0,1,1 "));  // of any length
}

TEST(PoseJson, QuaternionOrderIsNotRealPartFirst) {
  const auto pose = read_pose("0,0,0,1,0,0,0");  // half a turn about x, not "no turn"
  ASSERT_TRUE(pose);
  EXPECT_LT((*pose * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
}

TEST(PoseJson, RoundedRotationIsMadeExact) {
  const auto pose = parse_pose_json(
      R"({"T_base_sensor": [[0.7071, -0.7071, 0, 0], [0.7071, 0.7071, 0, 0], [0, 0, 1, 0], [1e-8, 0, 0, 1]]})",
      "");
  ASSERT_TRUE(pose) << pose.error().message();
  EXPECT_LT((pose->linear() * pose->linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(PoseJson, ScaledRotationIsRefused) {
  refused(R"({"T_base_sensor": [[1.01, 0, 0, 0], [0, 1.01, 0, 0], [0, 0, 1.01, 0]]})");
}

TEST(PoseJson, MirrorIsRefused) {
  refused(R"({"T_base_sensor": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0]]})");
}

TEST(PoseJson, ColumnMajorMatrixIsRefused) {
  const Error error =
      refused(R"({"T_base_sensor": [[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]]})");
  EXPECT_NE(error.detail.find("last row"), std::string::npos);
}

TEST(PoseJson, OtherShapesAreRefused) {
  refused(
      R"({"T_base_sensor": [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]})");  // twelve numbers, but of 4x3
  refused(R"({"T_base_sensor": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]})");
  refused(R"({"T_base_sensor": [[1, 0, 0, 0, 0, 1, 0, 0], [0, 0, 1, 0]]})");
  refused(R"({"T_base_sensor": [[1, 0, 0, 0, 0, 1, 0, 0], [0, 0, 1, 0], []]})");
  refused(R"({"T_base_sensor": [[[1, 0, 0, 0]], [0, 1, 0, 0], [0, 0, 1, 0]]})");
  refused(R"({"T_base_sensor": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})");
  refused(R"({"T_base_sensor": []})");
  refused(R"({"T_base_sensor": 5})");
  refused(R"({"T_base_sensor": null})");
}

TEST(PoseJson, ValuesThatAreNoNumbersAreRefused) {
  refused(R"({"T_base_sensor": [[1, 0, 0, "0"], [0, 1, 0, 0], [0, 0, 1, 0]]})");
  refused(R"({"T_base_sensor": [[1, 0, 0, null], [0, 1, 0, 0], [0, 0, 1, 0]]})");
  refused(R"({"T_base_sensor": [[1, 0, 0, NaN], [0, 1, 0, 0], [0, 0, 1, 0]]})");
  refused(R"({"T_base_sensor": [[1, 0, 0, 1e999], [0, 1, 0, 0], [0, 0, 1, 0]]})");
  refused(R"({"T_base_sensor": [[1e200, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]})");
}

TEST(PoseJson, MillimetresAreRefusedAsTooFar) {
  const Error error = refused(R"({"T_base_sensor": [[1, 0, 0, 1340], [0, 1, 0, 0], [0, 0, 1, 0]]})");
  EXPECT_NE(error.detail.find("metres"), std::string::npos);
  EXPECT_FALSE(read_pose("1340,0,0,0,0,0,1"));
}

TEST(PoseJson, MissingKeyAndBrokenJsonAreRefused) {
  EXPECT_NE(refused("{}").detail.find("T_base_sensor"), std::string::npos);
  EXPECT_NE(refused("{\n\"T_base_sensor\": [,").detail.find("line 2"), std::string::npos);
  refused("");
  refused("[1]");
  refused("{\"T_base_sensor\": " + std::string(100000, '[') + std::string(100000, ']') + "}");
}

TEST(PoseJson, TextThatIsNoPoseIsRefused) {
  for (const std::string text :
       {"", "guess.json", "1,2,3", "1,2,3,0,0,0,1,", "1,2,3,0,0,0,1,5", "1,2,,0,0,0,1", "1,2,3,0,0,0,1x",
        "1 2 3 0 0 0 1", "nan,0,0,0,0,0,1", "0,inf,0,0,0,0,1", "0,0,0,0,0,0,0",
        "0,0,0,1e308,1e308,1e308,1e308", "1e999,0,0,0,0,0,1"}) {
    const auto pose = read_pose(text);
    ASSERT_FALSE(pose) << text;
    EXPECT_EQ(pose.error().code, make_error_code(CaptureError::bad_pose_file)) << text;
  }
}

TEST(PoseJson, FolderInPlaceOfAPoseFileIsNoCrash) {
  const ScratchFolder folder;
  const auto pose = read_pose(folder.path().string());
  ASSERT_FALSE(pose);
  EXPECT_EQ(pose.error().code, make_error_code(CaptureError::unreadable));
}

}  // namespace
}  // namespace calibrd
