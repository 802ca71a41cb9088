// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>

#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

class DiffRoutes : public RouteTest {
 protected:
  void SetUp() override {
    CalibrationResult result;
    result.verdict = Verdict::accepted;
    result.covariance = Matrix6d::Identity() * 1e-8;  // 0.1 mm, 0.1 mrad in every direction
    result.sigma_position_m = result.sigma_rotation_rad = 3e-4;
    result.T_base_sensor = Pose(Eigen::Translation3d(0, 0, 1));
    cell_.calibration_report.result = result;
    result.T_base_sensor =
        Eigen::Translation3d(0.003, 0, 1) * Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitZ());
    result.sigma_position_m = result.sigma_rotation_rad = 4e-4;
    cell_.other_calibration = cell_.calibration_report;
    cell_.other_calibration.id = "c2";
    cell_.other_calibration.result = result;
    cell_.points = {{"tray", {1, 0, 1}}};
  }
  double at(const char* key, std::size_t i) { return body().at(key).at(i).to_number<double>(); }
};

/// A sensor 3 mm further along x and turned by 10 mrad about z puts what it sees 1 m before it 10 mm aside.
TEST_F(DiffRoutes, TellsWhatTheDifferenceMeansAtThePointsOfTheWorkspace) {
  ASSERT_EQ(get("/api/v1/calibrations/c1/diff/c2").status, 200);
  EXPECT_NEAR(at("translation_mm", 0), 3, 1e-9);
  EXPECT_NEAR(at("rotation_mrad", 2), 10, 1e-9);
  EXPECT_NEAR(body().at("distance_mm").to_number<double>(), 3, 1e-9);
  EXPECT_NEAR(body().at("angle_mrad").to_number<double>(), 10, 1e-9);
  EXPECT_NEAR(body().at("sigma_position_mm").to_number<double>(), 0.5, 1e-9) << "0.3 and 0.4";
  const auto point = body().at("workspace").at(0);
  EXPECT_EQ(point.at("name"), "tray");
  EXPECT_NEAR(point.at("displacement_mm").at(0).to_number<double>(), 3 - 0.05, 1e-3);
  EXPECT_NEAR(point.at("displacement_mm").at(1).to_number<double>(), 10, 1e-3);
  EXPECT_NEAR(point.at("displacement_mm").at(2).to_number<double>(), 0, 1e-9);
  EXPECT_GT(point.at("sigma_mm").to_number<double>(), 0);
}

TEST_F(DiffRoutes, TheWayBackIsTheOpposite) {
  get("/api/v1/calibrations/c1/diff/c2");
  const double there = at("translation_mm", 0);
  get("/api/v1/calibrations/c2/diff/c1");
  EXPECT_NEAR(at("translation_mm", 0), -there, 1e-9);
}

TEST_F(DiffRoutes, RefusesWhatCannotBeCompared) {
  EXPECT_EQ(get("/api/v1/calibrations/c1/diff/nothing").status, 404);
  cell_.other_calibration.result->T_base_sensor.reset();
  EXPECT_EQ(get("/api/v1/calibrations/c1/diff/c2").status, 409);
  EXPECT_EQ(code(), "not_comparable");
  EXPECT_NE(detail().find("c2"), std::string::npos);
  cell_.other_calibration = cell_.calibration_report;
  cell_.other_calibration.id = "c2";
  cell_.other_calibration.sensor_id = "other";
  EXPECT_EQ(get("/api/v1/calibrations/c1/diff/c2").status, 409);
}

}  // namespace
}  // namespace calibrd::api
