// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/normal_equations.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {

void NormalEquations::add(const Observation& o, std::size_t id) {
  const double weight = o.robust_weight / (o.sigma * o.sigma);
  if (weight <= 0) return;
  const ParameterVector pull = weight * o.residual * o.jacobian;
  information_.selfadjointView<Eigen::Lower>().rankUpdate(o.jacobian, weight);
  gradient_ += pull;
  weight_sum_ += o.robust_weight;
  squared_sum_ += o.robust_weight * o.residual * o.residual / (o.sigma * o.sigma);
  residual_squares_ += o.robust_weight * o.residual * o.residual;
  ++count_;
  if (id >= clusters_.size()) clusters_.resize(id + 1);
  Cluster& cluster = clusters_[id];
  const double whitened = o.robust_weight * o.residual / o.sigma;
  cluster.gradient += pull;
  cluster.whitened_sum += whitened;
  cluster.whitened_squares += whitened * whitened;
}

void NormalEquations::merge(const NormalEquations& other) {
  information_ += other.information_;
  gradient_ += other.gradient_;
  weight_sum_ += other.weight_sum_;
  squared_sum_ += other.squared_sum_;
  residual_squares_ += other.residual_squares_;
  count_ += other.count_;
  clusters_.insert(clusters_.end(), other.clusters_.begin(), other.clusters_.end());
}

NormalEquations NormalEquations::scaled(double factor) const {
  NormalEquations result = *this;
  result.information_ *= factor;
  result.gradient_ *= factor;
  result.squared_sum_ *= factor;
  for (Cluster& cluster : result.clusters_) cluster.gradient *= factor;
  return result;
}

double NormalEquations::rms_residual() const {
  return weight_sum_ > 0 ? std::sqrt(residual_squares_ / weight_sum_) : 0;
}

double NormalEquations::correlation_factor() const {
  double sums = 0, squares = 0;
  for (const Cluster& cluster : clusters_) {
    sums += cluster.whitened_sum * cluster.whitened_sum;
    squares += cluster.whitened_squares;
  }
  return squares > 0 ? std::max(1.0, sums / squares) : 1.0;
}

std::size_t NormalEquations::cluster_count() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(clusters_, [](const Cluster& cluster) { return cluster.whitened_squares > 0; }));
}

ParameterMatrix NormalEquations::cluster_scatter() const {
  ParameterMatrix scatter = ParameterMatrix::Zero();
  for (const Cluster& cluster : clusters_) scatter += cluster.gradient * cluster.gradient.transpose();
  return scatter;
}

}  // namespace calibrd
