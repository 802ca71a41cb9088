// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/cloud_registration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace calibrd {
namespace {

using Cloud = std::vector<Eigen::Vector3f>;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A workpiece on a table: a slanted block and half a cylinder. Points at random, about 4 mm apart.
Cloud workpiece(std::uint64_t seed, double noise_m = 0) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> noise(0, noise_m > 0 ? noise_m : 1);
  Cloud cloud;
  const auto add = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
    cloud.push_back((p + (noise_m > 0 ? noise(random) : 0.0) * normal).cast<float>());
  };
  const Eigen::Matrix3d slanted =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.2, 0.3, 1).normalized()).toRotationMatrix();
  for (int i = 0; i < 4000; ++i)  // the table
    add({0.5 * share(random) - 0.25, 0.5 * share(random) - 0.25, 0}, Eigen::Vector3d::UnitZ());
  for (int i = 0; i < 2400; ++i) {  // three faces of the block
    Eigen::Vector3d p(share(random) - 0.5, share(random) - 0.5, share(random) - 0.5);
    p[i % 3] = 0.5;
    add(slanted * (0.12 * p) + Eigen::Vector3d(-0.08, 0.05, 0.07), slanted.col(i % 3));
  }
  for (int i = 0; i < 1600; ++i) {
    const double angle = std::numbers::pi * share(random);
    const Eigen::Vector3d normal(std::cos(angle), 0, std::sin(angle));
    add(0.05 * normal + Eigen::Vector3d(0.12, 0.3 * share(random) - 0.15, 0), normal);
  }
  return cloud;
}

Cloud moved(const Pose& T, const Cloud& cloud) {
  Cloud result;
  for (const auto& p : cloud) result.push_back((T * p.cast<double>()).cast<float>());
  return result;
}

template <class Keep>
Cloud part(const Cloud& cloud, Keep keep) {
  Cloud result;
  for (const auto& p : cloud)
    if (keep(p)) result.push_back(p);
  return result;
}

/// 40 mm and 4° off.
Pose offset() {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
  return Eigen::Translation3d(0.02, -0.03, 0.0173) * Eigen::AngleAxisd(0.07, axis) * Pose::Identity();
}

/// Where the result puts the source against where it belongs: rms, m.
double displacement_m(const Cloud& source, const Pose& truth, const Pose& found) {
  double squares = 0;
  for (const auto& p : source) squares += (truth * p.cast<double>() - found * p.cast<double>()).squaredNorm();
  return std::sqrt(squares / static_cast<double>(source.size()));
}

void expect_found(const Cloud& source, const Cloud& target, const Pose& T_target_source, double tolerance_m) {
  const auto found = register_clouds(source, target, {});
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_TRUE(found->converged);
  EXPECT_LT(displacement_m(source, T_target_source, found->T_target_source), tolerance_m);
}

void expect_error(const Cloud& source, const Cloud& target, CloudRegistrationError error) {
  const auto found = register_clouds(source, target, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, make_error_code(error)) << found.error().message();
}

TEST(CloudRegistration, RecoversAKnownMotionBetweenDifferentSamples) {
  const Cloud target = workpiece(1), source = moved(offset().inverse(), workpiece(2));
  expect_found(source, target, offset(), 0.1e-3);
}

TEST(CloudRegistration, NoiseInEitherCloudAveragesOut) {
  expect_found(moved(offset().inverse(), workpiece(4, 1e-3)), workpiece(3), offset(), 0.2e-3);
  expect_found(moved(offset().inverse(), workpiece(5)), workpiece(6, 1e-3), offset(), 0.2e-3);
}

TEST(CloudRegistration, PartialOverlapDoesNotPull) {
  // Each shows a quarter of the scene that the other does not, and the source a wall that nobody else sees.
  const Cloud target = part(workpiece(7, 0.5e-3), [](const auto& p) { return p.y() > -0.12F; });
  Cloud source = part(workpiece(8, 0.5e-3), [](const auto& p) { return p.y() < 0.12F; });
  for (int i = 0; i < 1500; ++i)
    source.emplace_back(-0.1F + 0.004F * static_cast<float>(i % 50), -0.24F,
                        0.004F * static_cast<float>(i / 50));
  expect_found(moved(offset().inverse(), source), target, offset(), 0.2e-3);
  const auto found = register_clouds(moved(offset().inverse(), source), target, {});
  ASSERT_TRUE(found);
  EXPECT_GT(found->overlap, 0.4);
  EXPECT_LT(found->overlap, 0.85);
}

TEST(CloudRegistration, FarFromTheOriginNothingChanges) {
  const Pose away(Eigen::Translation3d(80, -60, 20));
  const Cloud target = moved(away, workpiece(1)), source = moved(away * offset().inverse(), workpiece(2));
  expect_found(source, target, away * offset() * away.inverse(), 0.15e-3);
}

TEST(CloudRegistration, PointsThatAreNoNumbersAreLeftOut) {
  Cloud source = moved(offset().inverse(), workpiece(2)), target = workpiece(1);
  for (std::size_t i = 0; i < source.size(); i += 7) source[i].y() = kNaN;
  for (std::size_t i = 0; i < target.size(); i += 5)
    target[i] = {std::numeric_limits<float>::infinity(), 0, kNaN};
  target[1] = {1e30F, -1e38F, 1};
  const auto found = register_clouds(source, target, {});
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_LT(displacement_m(workpiece(2), offset(), found->T_target_source), 0.2e-3);
}

TEST(CloudRegistration, SecondRunIsIdentical) {
  const Cloud target = workpiece(1), source = moved(offset().inverse(), workpiece(2));
  const auto one = register_clouds(source, target, {}), two = register_clouds(source, target, {});
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->T_target_source.matrix(), two->T_target_source.matrix());
}

TEST(CloudRegistration, LargeCloudsAreThinned) {
  Cloud source, target;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const auto& p : workpiece(10 + seed)) target.push_back(p);
    for (const auto& p : moved(offset().inverse(), workpiece(40 + seed))) source.push_back(p);
  }
  expect_found(source, target, offset(), 0.1e-3);
}

TEST(CloudRegistration, EmptyCloudsAreRefused) {
  expect_error({}, workpiece(1), CloudRegistrationError::too_few_points);
  expect_error(workpiece(1), {}, CloudRegistrationError::too_few_points);
  expect_error({}, {}, CloudRegistrationError::too_few_points);
  expect_error(Cloud(1000, Eigen::Vector3f::Constant(kNaN)), workpiece(1),
               CloudRegistrationError::too_few_points);
  expect_error(workpiece(1), Cloud(1000, Eigen::Vector3f::Constant(kNaN)),
               CloudRegistrationError::too_few_points);
}

TEST(CloudRegistration, CloudsApartAreRefused) {
  const Pose far(Eigen::Translation3d(3, 0, 0)), above(Eigen::Translation3d(0, 0, 0.4));
  expect_error(workpiece(1), moved(far, workpiece(2)), CloudRegistrationError::no_overlap);
  expect_error(workpiece(1), moved(above, workpiece(2)), CloudRegistrationError::no_overlap);
}

TEST(CloudRegistration, WhatSlidesOnItselfIsRefused) {
  const auto table = [](const Eigen::Vector3f& p) {
    return p.z() < 0.004F && p.x() < 0.05F && p.x() > -0.22F;
  };
  const auto cylinder = [](const Eigen::Vector3f& p) { return p.z() > 0.01F && p.x() > 0.07F; };
  for (const double noise_m : {0.0, 0.3e-3}) {
    const Cloud target = workpiece(20, noise_m), source = workpiece(21, noise_m);
    expect_error(part(source, table), part(target, table), CloudRegistrationError::unobservable);
    expect_error(part(source, cylinder), part(target, cylinder), CloudRegistrationError::unobservable);
  }
}

TEST(CloudRegistration, AThickPlaneIsAPlane) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<float> side(-0.2F, 0.2F);
  std::normal_distribution<float> noise(0, 0.002F);
  Cloud source, target;
  for (int i = 0; i < 6000; ++i) {
    source.emplace_back(side(random), side(random), noise(random));
    target.emplace_back(side(random), side(random), noise(random));
  }
  expect_error(source, target, CloudRegistrationError::unobservable);
}

TEST(CloudRegistration, WhatIsNoSurfaceIsRefused) {
  Cloud line, spot(500, Eigen::Vector3f(1, 2, 3));
  for (int i = 0; i < 500; ++i) line.emplace_back(0.001F * static_cast<float>(i), 0.0F, 0.0F);
  expect_error(line, line, CloudRegistrationError::unobservable);
  expect_error(spot, spot, CloudRegistrationError::unobservable);
}

}  // namespace
}  // namespace calibrd
