// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/calibration_result_json.hpp"

#include <gtest/gtest.h>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>

namespace calibrd::api {
namespace {

namespace json = boost::json;

CalibrationResult accepted_result() {
  CalibrationResult result;
  result.verdict = Verdict::accepted;
  result.T_base_sensor =
      Pose(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()));
  for (int i = 0; i < 36; ++i) result.covariance(i / 6, i % 6) = i * 1e-7;
  result.sigma_position_m = 0.001;
  result.sigma_rotation_rad = 0.002;
  result.depth_correction = {1.001, -0.018, 0.004, 1.2, 0.5};
  result.joint_zeros = {{"joint_s", 0.001, 0.0002}, {"joint_l", -0.0004, 0.0009}};
  result.residual_rms_m = 0.003;
  result.coverage = 0.9;
  result.links = {{"link_5_b", 1200, 0.97}, {"hidden", 0, 0}};
  result.held_out_residual_m = 0.0012;
  result.runner_up_margin = 0.4;
  result.weak_directions = {{"along the line of sight", false, {0, 0.6, 0.8}, 0.004},
                            {"about the vertical axis of the robot", true, {0, 0, 1}, 0.005}};
  result.workspace = {{{"tray", {0.4, -0.2, 0.1}}, 0.0007}};
  result.views = 5;
  result.used_guess = true;
  result.reasons = {{"weak_direction", "the line of sight is weakly observed"}};
  result.time_total_ms = 812.5;
  return result;
}

TEST(CalibrationResultJson, HoldsEveryKeyOfTheContract) {
  const auto object = json::parse(calibration_result_json(accepted_result(), 12.0)).as_object();
  for (const auto* key :
       {"verdict", "T_base_sensor", "covariance", "sigma_position_m", "sigma_rotation_rad",
        "depth_correction", "joint_zeros", "residual_rms_m", "coverage", "links", "held_out_residual_m",
        "runner_up_margin", "weak_directions", "workspace", "views", "used_guess", "reasons", "time_ms"})
    EXPECT_TRUE(object.contains(key)) << key;
  EXPECT_EQ(object.at("verdict"), "accepted");
  EXPECT_EQ(object.at("T_base_sensor").as_array().size(), 4U);
  EXPECT_DOUBLE_EQ(object.at("T_base_sensor").at(0).at(3).to_number<double>(), 1.0);
  EXPECT_EQ(object.at("covariance").as_array().size(), 6U);
  EXPECT_DOUBLE_EQ(object.at("covariance").at(1).at(0).to_number<double>(), 6e-7);
  EXPECT_DOUBLE_EQ(object.at("depth_correction").at("offset_m").to_number<double>(), -0.018);
  EXPECT_DOUBLE_EQ(object.at("time_ms").at("load").to_number<double>(), 12.0);
}

TEST(CalibrationResultJson, ListsHypothesesWhereThereAreAny) {
  auto result = accepted_result();
  EXPECT_FALSE(json::parse(calibration_result_json(result)).as_object().contains("hypotheses"));
  result.hypotheses = {{Pose(Eigen::Translation3d(1, 2, 3)), 0.8}};
  const auto object = json::parse(calibration_result_json(result)).as_object();
  ASSERT_EQ(object.at("hypotheses").as_array().size(), 1U);
  EXPECT_DOUBLE_EQ(object.at("hypotheses").at(0).at("score").to_number<double>(), 0.8);
  EXPECT_DOUBLE_EQ(object.at("hypotheses").at(0).at("T_base_sensor").at(1).at(3).to_number<double>(), 2);
}

TEST(CalibrationResultJson, RejectedCarriesNoPose) {
  auto result = accepted_result();
  result.verdict = Verdict::rejected;
  EXPECT_FALSE(json::parse(calibration_result_json(result)).as_object().contains("T_base_sensor"));
}

TEST(CalibrationResultJson, ReadsBackTheSame) {
  const auto result = accepted_result();
  const auto read = parse_calibration_result(calibration_result_json(result));
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_TRUE(read->T_base_sensor->isApprox(*result.T_base_sensor, 1e-15));
  EXPECT_TRUE(read->covariance.isApprox(result.covariance, 1e-14));
  EXPECT_EQ(read->verdict, result.verdict);
  EXPECT_DOUBLE_EQ(read->depth_correction.periodic_period_m, result.depth_correction.periodic_period_m);
  ASSERT_EQ(read->joint_zeros.size(), 2U);
  EXPECT_EQ(read->joint_zeros[1].joint, "joint_l");
  EXPECT_DOUBLE_EQ(read->joint_zeros[1].zero, -0.0004);
  EXPECT_DOUBLE_EQ(read->joint_zeros[1].sigma, 0.0009);
  EXPECT_DOUBLE_EQ(read->coverage, result.coverage);
  EXPECT_EQ(read->views, result.views);
  ASSERT_EQ(read->links.size(), 1U);  // those predicted visible
  EXPECT_EQ(read->links[0].predicted, 1200U);
  EXPECT_DOUBLE_EQ(read->links[0].coverage, 0.97);
  EXPECT_EQ(read->held_out_residual_m, result.held_out_residual_m);
  EXPECT_EQ(read->runner_up_margin, result.runner_up_margin);
  ASSERT_EQ(read->weak_directions.size(), 2U);
  EXPECT_FALSE(read->weak_directions[0].is_rotation);
  EXPECT_TRUE(read->weak_directions[1].is_rotation);
  EXPECT_DOUBLE_EQ(read->weak_directions[0].direction_base.y(), 0.6);
  EXPECT_DOUBLE_EQ(read->weak_directions[1].sigma, 0.005);
  ASSERT_EQ(read->workspace.size(), 1U);
  EXPECT_EQ(read->workspace[0].point.name, "tray");
  EXPECT_DOUBLE_EQ(read->workspace[0].point.p_base.y(), -0.2);
  EXPECT_DOUBLE_EQ(read->workspace[0].sigma_m, 0.0007);
  EXPECT_TRUE(read->used_guess);
  ASSERT_EQ(read->reasons.size(), 1U);
  EXPECT_EQ(read->reasons[0].text, result.reasons[0].text);
}

TEST(CalibrationResultJson, WhatWasInfiniteIsNotReadBackAsCertain) {
  auto result = accepted_result();
  result.covariance(4, 4) = result.sigma_position_m = std::numeric_limits<double>::infinity();
  const auto read = parse_calibration_result(calibration_result_json(result));
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_TRUE(std::isinf(read->covariance(4, 4)));
  EXPECT_TRUE(std::isinf(read->sigma_position_m));
}

TEST(CalibrationResultJson, DamagedTextIsRefused) {
  EXPECT_FALSE(parse_calibration_result("{\"verdict\": \"accepted\""));
  EXPECT_FALSE(parse_calibration_result("{\"verdict\": \"accepted\", \"T_base_sensor\": [[1]]}"));
}

}  // namespace
}  // namespace calibrd::api
