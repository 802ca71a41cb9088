// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "core/calibration/calibrate.hpp"
#include "tests/core/registration/scene.hpp"

namespace calibrd::test {

constexpr double kDegree = 0.0174532925199433;

/// The guess of a person with a ruler: 40 mm and 4 degrees off.
inline Pose rough_guess(std::uint64_t seed = 7) {
  return off_by(true_T_base_sensor(), 0.04, 4 * kDegree, seed);
}

inline CalibrationSettings from_guess(const Pose& guess_T_base_sensor) {
  CalibrationSettings settings;
  settings.guess_T_base_sensor = guess_T_base_sensor;
  return settings;
}

inline CalibrationResult calibrated(const std::vector<View>& views, const SceneSettings& scene = {},
                                    const Pose& guess_T_base_sensor = rough_guess()) {
  return calibrate(test_arm(), scene.camera, views, from_guess(guess_T_base_sensor));
}

inline bool has_reason(const CalibrationResult& result, std::string_view code) {
  return std::ranges::any_of(result.reasons, [code](const Reason& reason) { return reason.code == code; });
}

/// What a failed expectation shows.
inline std::string described(const CalibrationResult& result) {
  std::string text = result.verdict == Verdict::accepted    ? "accepted"
                     : result.verdict == Verdict::uncertain ? "uncertain"
                                                            : "rejected";
  for (const Reason& reason : result.reasons) text += " " + reason.code;
  if (result.T_base_sensor) {
    const Vector6d error = difference(true_T_base_sensor(), *result.T_base_sensor);
    text += ", off by " + std::to_string(1e3 * error.tail<3>().norm()) + " mm and " +
            std::to_string(1e3 * error.head<3>().norm()) + " mrad, claims " +
            std::to_string(1e3 * result.sigma_position_m) + " mm and " +
            std::to_string(1e3 * result.sigma_rotation_rad) + " mrad, coverage " +
            std::to_string(result.coverage) + ", zeros";
    for (const JointZero& zero : result.joint_zeros)
      text.append(1, ' ').append(std::to_string(1e3 * zero.zero));
  }
  return text;
}

/// Accepted, and no further than that from the truth.
inline void expect_accepted_within(const CalibrationResult& result, double position_m, double rotation_rad) {
  ASSERT_EQ(result.verdict, Verdict::accepted) << described(result);
  ASSERT_TRUE(result.T_base_sensor);
  const Vector6d error = difference(true_T_base_sensor(), *result.T_base_sensor);
  EXPECT_LT(error.tail<3>().norm(), position_m) << described(result);
  EXPECT_LT(error.head<3>().norm(), rotation_rad) << described(result);
}

/// What must never happen: a pose served as good that is not.
inline void expect_right_or_not_accepted(const CalibrationResult& result, double position_m,
                                         double rotation_rad) {
  if (result.verdict == Verdict::accepted) expect_accepted_within(result, position_m, rotation_rad);
}

inline void expect_rejected(const CalibrationResult& result, std::string_view code) {
  EXPECT_EQ(result.verdict, Verdict::rejected) << described(result);
  EXPECT_FALSE(result.T_base_sensor);
  EXPECT_TRUE(has_reason(result, code)) << described(result);
  for (const Reason& reason : result.reasons) EXPECT_GT(reason.text.size(), 20U) << reason.code;
}

}  // namespace calibrd::test
