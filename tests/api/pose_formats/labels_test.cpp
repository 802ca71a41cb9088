// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/pose_formats/pose_format.hpp"
#include "api/pose_formats/pose_text.hpp"
#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

class PoseFormatLabels : public RouteTest {
 protected:
  PoseFormatLabels() {
    cell_.make_calibrated();
    cell_.pose_report.controller_frame = ControllerFrame{"base", Pose(Eigen::Translation3d(0, 0, 0.31))};
  }
  Response ask_format(const std::string& format, std::map<std::string, std::string> headers = {}) {
    return get("/api/v1/sensors/kinect2/pose?format=" + format, std::move(headers));
  }
};

TEST_F(PoseFormatLabels, ThereAreFifteenFormats) {
  EXPECT_EQ(
      pose_format_names(),
      "matrix, quaternion, rotvec, ros2, ros1, urdf, kuka, fanuc, yaskawa, mitsubishi, kawasaki, abb, ur, "
      "halcon, opencv");
}

TEST_F(PoseFormatLabels, EveryPayloadSaysWhatItsNumbersMean) {
  for (const auto& format : pose_formats()) {
    EXPECT_EQ(ask_format(format.name).status, 200) << format.name;
    const auto told = body();
    EXPECT_EQ(told.at("format"), format.name);
    for (const auto* label : {"meaning", "sensor_axes", "length_unit", "order", "rotation", "source"})
      EXPECT_FALSE(told.at(label).as_string().empty()) << format.name << " " << label;
    const bool has_angles = format.angle_unit != nullptr;
    EXPECT_EQ(told.at("angle_unit").is_string(), has_angles) << format.name;
    EXPECT_EQ(told.at("calibration"), "c1");
    EXPECT_EQ(told.at("valid"), true);
    EXPECT_TRUE(told.contains("sigma_position_m") && told.contains("sigma_rotation_rad"));
  }
}

TEST_F(PoseFormatLabels, EveryPayloadNamesTheFramesItMapsBetween) {
  for (const auto& format : pose_formats()) {
    ask_format(format.name);
    const auto told = body();
    const bool inverse = format.reference == Reference::inverse;
    const std::string sensor = "kinect2_optical",
                      robot = format.reference == Reference::controller ? "base" : "base_link";
    EXPECT_EQ(told.at("from_frame").as_string(), inverse ? robot : sensor) << format.name;
    EXPECT_EQ(told.at("to_frame").as_string(), inverse ? sensor : robot) << format.name;
    EXPECT_EQ(told.at("inverse"), inverse) << format.name;
    const std::string meaning(told.at("meaning").as_string());
    const auto maps = inverse ? "maps points of base_link to kinect2_optical"
                              : "maps points of kinect2_optical to " + robot;
    EXPECT_NE(meaning.find(maps), std::string::npos) << meaning;
    EXPECT_EQ(meaning.find("inverse") != std::string::npos, inverse) << meaning;
  }
}

TEST_F(PoseFormatLabels, ControllersFormatsNeedAControllerFrameAndTheOthersDoNot) {
  cell_.pose_report.controller_frame.reset();
  for (const auto& format : pose_formats()) {
    const auto response = ask_format(format.name, {{"if-none-match", "*"}});
    if (format.reference != Reference::controller) {
      EXPECT_EQ(response.status, 304) << format.name;
      continue;
    }
    EXPECT_EQ(response.status, 409) << format.name;
    EXPECT_EQ(code(), "no_controller_frame");
    EXPECT_NE(body().at("remedy").as_string().find("robot.controller_frame"), std::string::npos);
    EXPECT_EQ(get(std::string("/api/v1/sensors/kinect2/pose?wait=30s&format=") + format.name,
                  {{"if-none-match", "*"}})
                  .worth_waiting,
              std::chrono::seconds(0));
  }
}

TEST_F(PoseFormatLabels, NoFormatGivesAPoseThatIsNotValidInAnyState) {
  for (const bool has_frame : {true, false}) {
    if (!has_frame) cell_.pose_report.controller_frame.reset();
    for (const auto state :
         {PoseState::uncalibrated, PoseState::calibrated, PoseState::unverified, PoseState::drifted})
      for (const auto& format : pose_formats()) {
        cell_.make_calibrated();
        cell_.pose_report.valid = false;
        cell_.pose_report.state = state;
        if (state == PoseState::uncalibrated) cell_.pose_report.known.reset();
        EXPECT_EQ(ask_format(format.name).status, 409) << format.name;
        EXPECT_EQ(code(), "pose_not_valid") << format.name;
        EXPECT_EQ(body().size(), 6u) << "more than a problem";
      }
  }
}

TEST_F(PoseFormatLabels, AnotherControllerFrameIsAnotherAnswer) {
  for (const auto& format : pose_formats()) {
    cell_.pose_report.controller_frame = ControllerFrame{"base", Pose(Eigen::Translation3d(0, 0, 0.31))};
    ask_format(format.name);
    const auto tag = header("ETag");
    EXPECT_EQ(ask_format(format.name, {{"if-none-match", tag}}).status, 304);
    const int other = format.reference == Reference::controller ? 200 : 304;
    cell_.pose_report.controller_frame->T_base_controller.translation().z() = 0.3;
    EXPECT_EQ(ask_format(format.name, {{"if-none-match", tag}}).status, other) << format.name;
    cell_.pose_report.controller_frame = ControllerFrame{"pedestal", Pose(Eigen::Translation3d(0, 0, 0.31))};
    EXPECT_EQ(ask_format(format.name, {{"if-none-match", tag}}).status, other) << format.name;
  }
}

TEST_F(PoseFormatLabels, NamesWithSpecialCharactersDoNotBreakTexts) {
  cell_.pose_report.base_frame = R"(robot's "base" & <link>)";
  cell_.pose_report.sensor_frame = "left eye";
  ask_format("ros2");
  const std::string ros2(body().at("text").as_string());
  EXPECT_NE(ros2.find(R"(--frame-id 'robot'\''s "base" & <link>' --child-frame-id 'left eye')"),
            std::string::npos)
      << ros2;
  EXPECT_EQ(body().at("body").at("from_frame"), "left eye_body");
  ask_format("urdf");
  const std::string urdf(body().at("text_joint").as_string());
  EXPECT_NE(urdf.find(R"(<parent link="robot's &quot;base&quot; &amp; &lt;link>"/>)"), std::string::npos)
      << urdf;
}

TEST(Decimals, HaveNineDigitsAndNoMinusZero) {
  EXPECT_EQ(decimals(-1.5), "-1.500000000");
  EXPECT_EQ(decimals(-1e-12), "0.000000000");
  EXPECT_EQ(decimals(-1e-9), "-0.000000001");
  EXPECT_EQ(decimal_list({1, 2}, ", "), "1.000000000, 2.000000000");
}

}  // namespace
}  // namespace calibrd::api
