// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json.hpp>
#include <fstream>
#include <sstream>

#include "core/calibration/model_views.hpp"
#include "core/capture/pose_json.hpp"
#include "tests/core/calibration/calibrated.hpp"
#include "tests/core/robot/shared_data.hpp"

namespace calibrd {
namespace {

using namespace test;
namespace fs = std::filesystem;

struct Recording {
  RobotModel robot;
  CameraModel camera;
  std::vector<View> views;
};

Recording load(const fs::path& folder) {
  const std::vector<fs::path> models{shared_data() / "models"};
  auto capture = read_capture(folder, models);
  if (!capture) throw std::runtime_error(capture.error().message());
  auto robot = RobotModel::load(capture->urdf, {{folder, models[0]}, capture->base_link});
  if (!robot) throw std::runtime_error(robot.error().message());
  const CameraModel camera = capture->camera;
  auto views = views_in_model_order(*robot, std::move(*capture));
  if (!views) throw std::runtime_error(views.error().message());
  return {std::move(*robot), camera, std::move(*views)};
}

boost::json::value json_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return boost::json::parse(text.str());
}

Eigen::Vector3d vector_of(const boost::json::value& numbers) {
  return {numbers.at(0).to_number<double>(), numbers.at(1).to_number<double>(),
          numbers.at(2).to_number<double>()};
}

class SimulatedRecording : public testing::TestWithParam<const char*> {
 protected:
  /// Calibrates from 40 mm and 4 degrees off; error (rad, m) where there is a pose.
  void SetUp() override {
    const fs::path folder = shared_data() / "sim" / GetParam();
    SKIP_WITHOUT(folder);
    const auto truth = read_pose((folder / "truth.json").string());
    ASSERT_TRUE(truth) << truth.error().message();
    const Recording recording = load(folder);
    result = calibrate(recording.robot, recording.camera, recording.views,
                       from_guess(off_by(*truth, 0.04, 4 * kDegree, 11)));
    if (result.T_base_sensor) error = difference(*truth, *result.T_base_sensor);
  }
  std::string summary() const {
    return described(result).substr(0, described(result).find(',')) + ", error " +
           std::to_string(1e3 * error.tail<3>().norm()) + " mm, " +
           std::to_string(1e3 * error.head<3>().norm()) + " mrad";
  }
  CalibrationResult result;
  Vector6d error = Vector6d::Zero();
};

class CleanTenPostures : public SimulatedRecording {};

TEST_P(CleanTenPostures, AreCalibratedWithinAMillimetreAndAMilliradian) {
  ASSERT_EQ(result.verdict, Verdict::accepted) << summary();
  EXPECT_LT(error.tail<3>().norm(), 1e-3) << summary();
  EXPECT_LT(error.head<3>().norm(), 1e-3) << summary();
}

INSTANTIATE_TEST_SUITE_P(, CleanTenPostures, testing::Values("clean_k10_1", "clean_k10_2"),
                         [](const auto& test) { return test.param; });

class OtherSimulated : public SimulatedRecording {};

TEST_P(OtherSimulated, AreRightOrNotAccepted) {
  if (result.verdict != Verdict::accepted) return;
  EXPECT_LT(error.tail<3>().norm(), 5e-3) << summary();
  EXPECT_LT(error.head<3>().norm(), 5e-3) << summary();
}

INSTANTIATE_TEST_SUITE_P(, OtherSimulated,
                         testing::Values("clean_k1_1", "clean_k1_2", "cell_k1_1", "cell_k1_2", "cell_k10_1",
                                         "cell_k10_2", "field_k10_1", "field_k10_2"),
                         [](const auto& test) { return test.param; });

class TrueToItsJoints : public SimulatedRecording {};

TEST_P(TrueToItsJoints, IsWithinItsClaimWhenAccepted) {
  if (result.verdict != Verdict::accepted) return;
  EXPECT_LT(error.dot(result.covariance.ldlt().solve(error)), 38.3) << summary();  // once in a million
}

INSTANTIATE_TEST_SUITE_P(, TrueToItsJoints,
                         testing::Values("clean_k1_1", "clean_k1_2", "cell_k1_1", "cell_k1_2", "cell_k10_1",
                                         "cell_k10_2"),
                         [](const auto& test) { return test.param; });

/// Joint zeros are off: the pose that is right for the joints as reported is not that of the base, but takes
/// what the sensor sees to where the robot believes it is.
class WithJointZerosOff : public SimulatedRecording {};

TEST_P(WithJointZerosOff, TakesCheckPointsToTheirPlaces) {
  const fs::path folder = shared_data() / "sim" / GetParam();
  ASSERT_TRUE(result.T_base_sensor) << summary();
  const auto points = json_of(folder / "truth.json").at("check_points").as_array();
  double squares = 0;
  for (const auto& point : points)
    squares += (*result.T_base_sensor * vector_of(point.at("p_sensor")) - vector_of(point.at("p_base")))
                   .squaredNorm();
  ASSERT_GT(points.size(), 10U);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(points.size())), 2.5e-3) << summary();
}

INSTANTIATE_TEST_SUITE_P(, WithJointZerosOff, testing::Values("field_k10_1", "field_k10_2"),
                         [](const auto& test) { return test.param; });

Pose reference_pose(const fs::path& file, const char* name) {
  const auto document = json_of(file);
  const auto pose = parse_pose_json(boost::json::serialize(document.at(name)), name);
  if (!pose) throw std::runtime_error(pose.error().message());
  return *pose;
}

// A real arm, a real stereo camera, and a second arm of the same make in the picture.
TEST(RealRecording, EndsAtOnePoseFromFiveGuesses) {
  const fs::path folder = shared_data() / "real/lbr_med7_zed2i";
  SKIP_WITHOUT(folder);
  const Pose reference = reference_pose(folder / "references.json", "HT_hydra_robust");
  const Recording recording = load(folder);
  std::vector<Pose> ends;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Pose guess =
        off_by(reference, 0.01 * static_cast<double>(seed), static_cast<double>(seed) * kDegree, seed);
    const CalibrationResult result =
        calibrate(recording.robot, recording.camera, recording.views, from_guess(guess));
    EXPECT_EQ(result.verdict, Verdict::accepted) << described(result);
    ASSERT_TRUE(result.T_base_sensor);
    ends.push_back(*result.T_base_sensor);
  }
  for (const Pose& a : ends) {
    for (const Pose& b : ends) {
      EXPECT_LT(difference(a, b).tail<3>().norm(), 2e-3);
      EXPECT_LT(difference(a, b).head<3>().norm(), 2e-3);
    }
    EXPECT_LT(difference(reference, a).tail<3>().norm(), 0.02);  // the peer's pose, no truth
  }
}

}  // namespace
}  // namespace calibrd
