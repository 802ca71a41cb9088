// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/normal_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace calibrd {
namespace {

ParameterMatrix full(const NormalEquations& equations) {
  return equations.information().selfadjointView<Eigen::Lower>();
}

/// Observations of a line: y = truth · jacobian + noise.
struct Example {
  explicit Example(std::uint64_t seed) : random(seed) {}
  Observation next(double sigma) {
    Observation o;
    for (int k = 0; k < kParameters; ++k) o.jacobian[k] = normal(random);
    o.sigma = sigma;
    o.residual = truth.dot(o.jacobian) + sigma * normal(random);
    return o;
  }
  ParameterVector truth = ParameterVector::LinSpaced(-1, 1);
  std::mt19937_64 random;
  std::normal_distribution<double> normal;
};

TEST(NormalEquations, SolveALineThroughWeightedObservations) {
  Example example(1);
  NormalEquations equations;
  for (std::size_t i = 0; i < 3000; ++i) equations.add(example.next(i % 2 == 0 ? 0.01 : 1.0), i);
  const ParameterVector solution = full(equations).ldlt().solve(equations.gradient());
  // 1500 observations of 0.01 each: about 0.01/√1500 per parameter; the bad half would give 0.03.
  EXPECT_LT((solution - example.truth).cwiseAbs().maxCoeff(), 0.0015);
  EXPECT_EQ(equations.count(), 3000U);
}

TEST(NormalEquations, InformationIsTheSumOfWeightedOuterProducts) {
  Observation o;
  o.jacobian = ParameterVector::LinSpaced(1, kParameters);
  o.residual = 3;
  o.sigma = 2;
  o.robust_weight = 0.5;
  NormalEquations equations;
  equations.add(o, 0);
  const double weight = 0.5 / 4;
  EXPECT_TRUE(full(equations).isApprox(weight * o.jacobian * o.jacobian.transpose()));
  EXPECT_TRUE(equations.gradient().isApprox(weight * 3 * o.jacobian));
  EXPECT_DOUBLE_EQ(equations.rms_residual(), 3);
}

TEST(NormalEquations, WeightlessObservationCountsForNothing) {
  Observation o;
  o.jacobian.setOnes();
  o.residual = 1e9;
  o.robust_weight = 0;
  NormalEquations equations;
  equations.add(o, 5);
  EXPECT_EQ(equations.count(), 0U);
  EXPECT_EQ(equations.rms_residual(), 0);
  EXPECT_EQ(equations.correlation_factor(), 1);
}

TEST(NormalEquations, MergedHalvesEqualTheWhole) {
  Example example(2);
  NormalEquations whole, first, second;
  for (std::size_t i = 0; i < 200; ++i) {
    const Observation o = example.next(0.5);
    whole.add(o, i / 10);
    (i < 100 ? first : second).add(o, i % 100 / 10);  // both halves number their clusters from 0
  }
  first.merge(second);
  EXPECT_TRUE(full(first).isApprox(full(whole), 1e-12));
  EXPECT_TRUE(first.gradient().isApprox(whole.gradient(), 1e-12));
  EXPECT_TRUE(first.cluster_scatter().isApprox(whole.cluster_scatter(), 1e-12));
  EXPECT_EQ(first.count(), whole.count());
  EXPECT_NEAR(first.rms_residual(), whole.rms_residual(), 1e-12);
  EXPECT_NEAR(first.correlation_factor(), whole.correlation_factor(), 1e-12);
}

TEST(NormalEquations, ScalingWeighsButMovesNoSolution) {
  Example example(3);
  NormalEquations equations;
  for (std::size_t i = 0; i < 100; ++i) equations.add(example.next(0.5), i);
  const NormalEquations scaled = equations.scaled(0.25);
  EXPECT_TRUE(full(scaled).isApprox(0.25 * full(equations), 1e-12));
  EXPECT_TRUE(full(scaled)
                  .ldlt()
                  .solve(scaled.gradient())
                  .isApprox(full(equations).ldlt().solve(equations.gradient()), 1e-9));
  EXPECT_TRUE(scaled.cluster_scatter().isApprox(0.0625 * equations.cluster_scatter(), 1e-12));
  EXPECT_DOUBLE_EQ(scaled.rms_residual(), equations.rms_residual());
  EXPECT_DOUBLE_EQ(scaled.correlation_factor(), equations.correlation_factor());
}

TEST(NormalEquations, IndependentErrorsHaveACorrelationFactorOfOne) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  NormalEquations equations;
  for (std::size_t i = 0; i < 40000; ++i) {
    Observation o;
    o.jacobian.setOnes();
    o.residual = normal(random);
    equations.add(o, i / 40);  // 1000 clusters of 40
  }
  EXPECT_NEAR(equations.correlation_factor(), 1.0, 0.15);
  EXPECT_GE(equations.correlation_factor(), 1.0);
}

// m observations that share the error s beside their own of 1 scatter by (1 + s² m)/(1 + s²) more than
// independent ones.
TEST(NormalEquations, SharedErrorsOfAClusterRaiseTheCorrelationFactor) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr double kShared = 0.5, kMembers = 40;
  NormalEquations equations;
  for (std::size_t cluster = 0; cluster < 2000; ++cluster) {
    const double shared = kShared * normal(random);
    for (int i = 0; i < kMembers; ++i) {
      Observation o;
      o.jacobian.setOnes();
      o.residual = shared + normal(random);
      equations.add(o, cluster);
    }
  }
  const double expected = (1 + kShared * kShared * kMembers) / (1 + kShared * kShared);
  EXPECT_NEAR(equations.correlation_factor(), expected, 0.1 * expected);
}

}  // namespace
}  // namespace calibrd
