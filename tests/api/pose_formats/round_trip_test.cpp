// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>

#include "api/pose_formats/pose_format.hpp"
#include "tests/api/pose_formats/hard_poses.hpp"
#include "tests/api/pose_formats/read_pose.hpp"
#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// m, rad.
constexpr double kNumbers = 1e-9, kTexts = 1e-6;

/// Every format of one pose after the other, through the route.
class PoseFormats : public RouteTest {
 protected:
  PoseFormats() {
    cell_.make_calibrated();
    cell_.pose_report.controller_frame = ControllerFrame{"base", T_base_controller_};
  }

  boost::json::object payload(const std::string& format, const Pose& T_base_sensor) {
    cell_.pose_report.known->result.T_base_sensor = T_base_sensor;
    EXPECT_EQ(get("/api/v1/sensors/kinect2/pose?format=" + format).status, 200) << format;
    return body();
  }

  /// A payload for which the frames of the format are placed as T: so that a gimbal lock is one of its own.
  boost::json::object payload_of(const PoseFormat& format, const Pose& T) {
    const bool is_controllers = std::string(" kuka fanuc yaskawa mitsubishi kawasaki abb ur ")
                                    .find(" " + std::string(format.name) + " ") != std::string::npos;
    if (is_controllers) return payload(format.name, T_base_controller_ * T);
    return payload(format.name, format.name == std::string("opencv") ? T.inverse() : T);
  }

  const Pose T_base_controller_ = Eigen::Translation3d(0.1, -0.2, 0.31) * AngleAxisd(2.5, Vector3d::UnitZ()) *
                                  AngleAxisd(0.3, Vector3d::UnitX());
};

void expect_near(const Pose& told, const Pose& truth, double tolerance, const std::string& of) {
  EXPECT_LT((told.translation() - truth.translation()).norm(), tolerance) << of;
  // Of small turns the matrix differs by the sine in two elements of each of two columns.
  EXPECT_LT((told.linear() - truth.linear()).norm() / std::sqrt(2.0), tolerance) << of << "\n"
                                                                                 << truth.matrix();
}

TEST_F(PoseFormats, NumbersOfEveryFormatGiveThePoseBack) {
  for (const auto& format : pose_formats())
    for (const auto& T : test::all_poses()) {
      expect_near(test::read_members(format.name, payload_of(format, T)), T, kNumbers, format.name);
      if (HasFailure()) break;  // one pose of a format tells enough
    }
}

TEST_F(PoseFormats, TextsGiveThePoseBack) {
  int texts = 0;
  for (const auto& format : pose_formats()) {
    if (!payload(format.name, Pose::Identity()).contains("text")) continue;
    ++texts;
    for (const auto& T : test::all_poses()) {
      expect_near(test::read_text(format.name, payload_of(format, T)), T, kTexts, format.name);
      if (HasFailure()) break;
    }
  }
  EXPECT_EQ(texts, 9);
}

TEST_F(PoseFormats, AnglesBesideTheQuaternionsOfRosSayTheSame) {
  for (const auto& T : test::all_poses()) {
    expect_near(test::read_members("ros2 rpy", payload("ros2", T)), T, kNumbers, "ros2");
    const auto ros1 = payload("ros1", T);
    const auto& ypr = ros1.at("yaw_pitch_roll_rad").as_array();
    boost::json::object turned = ros1;
    turned["roll_pitch_yaw_rad"] = boost::json::array{ypr[2], ypr[1], ypr[0]};
    expect_near(test::read_members("ros2 rpy", turned), T, kNumbers, "ros1");
    if (HasFailure()) break;
  }
}

TEST_F(PoseFormats, BodyFrameOfRosLooksAlongXAndStandsWhereTheOpticalFrameStands) {
  for (const std::string format : {"ros2", "ros1", "urdf"})
    for (const auto& T : test::all_poses()) {
      const auto beside = payload(format, T).at("body").as_object();
      EXPECT_EQ(beside.at("from_frame"), "kinect2");
      for (const auto& told : {test::read_members(format, beside), test::read_text(format, beside)}) {
        EXPECT_LT((told.translation() - T.translation()).norm(), kTexts);
        EXPECT_LT((told.linear() * Vector3d::UnitX() - T.linear() * Vector3d::UnitZ()).norm(), kTexts);
        EXPECT_LT((told.linear() * Vector3d::UnitY() + T.linear() * Vector3d::UnitX()).norm(), kTexts);
        EXPECT_LT((told.linear() * Vector3d::UnitZ() + T.linear() * Vector3d::UnitY()).norm(), kTexts);
      }
      if (HasFailure()) break;
    }
}

TEST_F(PoseFormats, TextOfTheOlderRos1PublisherEndsWithThePeriod) {
  for (const auto& T : test::random_poses(20)) {
    const auto told = payload("ros1", T);
    auto numbers = test::numbers_in(std::string(told.at("text_tf").as_string()));
    ASSERT_EQ(numbers.size(), 8u);
    EXPECT_EQ(numbers.back(), 100);
    numbers.pop_back();
    EXPECT_EQ(numbers, test::numbers_in(std::string(told.at("text").as_string())));
  }
}

/// Turns that anybody can check against a manual: 10, 20 and 30 degrees about z, the new y and the newest x.
TEST_F(PoseFormats, KnownTurnHasItsAnglesUnderTheNamesOfEachMake) {
  const double deg = M_PI / 180;
  Pose T_controller_sensor = Eigen::Translation3d(1, 2, 3) * AngleAxisd(10 * deg, Vector3d::UnitZ()) *
                             AngleAxisd(20 * deg, Vector3d::UnitY()) *
                             AngleAxisd(30 * deg, Vector3d::UnitX());
  const Pose T = T_base_controller_ * T_controller_sensor;
  const auto expect_angles = [&](const std::string& format, std::array<const char*, 3> names,
                                 std::array<double, 3> degrees) {
    const auto told = payload(format, T);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(told.at(names[i]).to_number<double>(), degrees[i], 1e-9) << format;
    EXPECT_NEAR(told.at("Y_mm").to_number<double>(), 2000, 1e-9) << format;
  };
  expect_angles("kuka", {"A_deg", "B_deg", "C_deg"}, {10, 20, 30});
  expect_angles("mitsubishi", {"A_deg", "B_deg", "C_deg"}, {30, 20, 10});
  expect_angles("fanuc", {"W_deg", "P_deg", "R_deg"}, {30, 20, 10});
  expect_angles("yaskawa", {"Rx_deg", "Ry_deg", "Rz_deg"}, {30, 20, 10});
}

}  // namespace
}  // namespace calibrd::api
