// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <random>

#include "core/registration/depth_noise.hpp"

namespace calibrd {
namespace {

/// Sums over observations whose errors have a part of their own (1) and a part shared in clusters of 20.
NormalEquations example(std::size_t count, double shared_sigma, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  NormalEquations equations;
  ParameterVector jacobian;
  double shared = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 20 == 0) {
      shared = shared_sigma * normal(random);
      for (int k = 0; k < kParameters; ++k) jacobian[k] = normal(random);
    }
    Observation o;
    o.jacobian = jacobian;
    for (int k = 0; k < kParameters; ++k) o.jacobian[k] += 0.3 * normal(random);
    o.residual = shared + normal(random);
    equations.add(o, i / 20);
  }
  return equations;
}

Matrix6d covariance_of(const NormalEquations& equations) {
  const ParameterMatrix information = equations.information().selfadjointView<Eigen::Lower>();
  return parameter_covariance(information, equations).topLeftCorner<6, 6>();
}

Matrix6d model_covariance(const NormalEquations& equations) {
  const ParameterMatrix information = equations.information().selfadjointView<Eigen::Lower>();
  return information.ldlt().solve(ParameterMatrix::Identity()).topLeftCorner<6, 6>();
}

TEST(PoseCovariance, IsSymmetricAndPositiveDefinite) {
  const Matrix6d covariance = covariance_of(example(2000, 1.0, 1));
  EXPECT_LT((covariance - covariance.transpose()).norm(), 1e-12 * covariance.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance).eigenvalues()[0], 0);
}

TEST(PoseCovariance, OfIndependentErrorsIsThatOfTheModel) {
  const NormalEquations equations = example(40000, 0.0, 2);
  EXPECT_TRUE(covariance_of(equations).isApprox(model_covariance(equations), 0.15));
}

TEST(PoseCovariance, NeverFallsBelowTheModelInAnyDirection) {
  const NormalEquations equations = example(400, 0.0, 3);  // few clusters: their scatter errs to both sides
  const Matrix6d more = covariance_of(equations) - model_covariance(equations);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(more).eigenvalues()[0], -1e-9 * more.norm());
}

// The covariance claimed from one data set against the scatter of the solutions of many.
TEST(PoseCovariance, OfCorrelatedErrorsCoversTheScatterOfSolutions) {
  Matrix6d scatter = Matrix6d::Zero(), claimed = Matrix6d::Zero();
  constexpr int kRuns = 300;
  for (int run = 0; run < kRuns; ++run) {
    const NormalEquations equations = example(4000, 1.0, 100 + static_cast<std::uint64_t>(run));
    const ParameterMatrix information = equations.information().selfadjointView<Eigen::Lower>();
    const Vector6d error = information.ldlt().solve(equations.gradient()).head<6>();  // the truth is 0
    scatter += error * error.transpose() / kRuns;
    claimed += covariance_of(equations) / kRuns;
  }
  const double ratio = scatter.trace() / claimed.trace();
  EXPECT_LT(ratio, 1.15);
  EXPECT_GT(ratio, 0.6);  // claims no absurd uncertainty either
}

// Fankhauser 2015, as printed for a Kinect v2 head on: 1.30, 1.37 and 1.70 mm at 1.0, 1.34 and 2.0 m.
TEST(DepthNoise, FollowsThePublishedFigures) {
  const double pixel_m = 1 / 365.456;
  EXPECT_NEAR(depth_sigma_m(1.0, 1.0, pixel_m), 1.30e-3, 1e-5);
  EXPECT_NEAR(depth_sigma_m(1.34, 1.0, pixel_m), 1.37e-3, 1e-5);
  EXPECT_NEAR(depth_sigma_m(2.0, 1.0, pixel_m), 1.70e-3, 1e-5);
}

TEST(DepthNoise, GrowsWithIncidenceAndStaysFiniteWhenGrazing) {
  double before = 0;
  for (const double cosine : {1.0, 0.8, 0.5, 0.25, 0.1, 0.0}) {
    const double sigma = depth_sigma_m(1.34, cosine, 1 / 365.456);
    EXPECT_TRUE(std::isfinite(sigma)) << cosine;
    EXPECT_GE(sigma, before) << cosine;
    before = sigma;
  }
}

}  // namespace
}  // namespace calibrd
