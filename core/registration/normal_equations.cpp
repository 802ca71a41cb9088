// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/normal_equations.hpp"

#include <cmath>

namespace calibrd {
namespace {

// This sum takes most of a registration's time: it is worth a copy for processors with wider registers. Their
// fused multiply-add rounds once less: the last bits of a result depend on the processor.
// Sanitizers cannot start programs that choose between copies.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CALIBRD_WIDE_REGISTERS __attribute__((target_clones("arch=haswell", "default")))
#else
#define CALIBRD_WIDE_REGISTERS
#endif

/// lower += weight v vᵀ, column-major columns of kRows values, whole blocks of four rows from the diagonal
/// on.
template <int kRows, int kColumns>
inline __attribute__((always_inline)) void add_outer(double* lower, const double* v, double weight) {
  for (int column = 0; column < kColumns; ++column) {
    if (v[column] == 0)
      continue;  // a range says nothing of the image, nor of joints that do not carry its link
    const double factor = weight * v[column];
    double* out = lower + column * kRows;
    for (int row = column / 4 * 4; row < kRows; ++row) out[row] += factor * v[row];
  }
}

CALIBRD_WIDE_REGISTERS void add_outer_21(double* lower, const double* v, double weight) {
  static_assert(kParameters == 21);
  add_outer<24, 21>(lower, v, weight);
}

}  // namespace

void NormalEquations::add(const Observation& o, std::size_t id) {
  const double weight = o.robust_weight / (o.sigma * o.sigma);
  if (weight <= 0) return;
  const ParameterVector pull = weight * o.residual * o.jacobian;
  Eigen::Matrix<double, kPadded, 1> padded = Eigen::Matrix<double, kPadded, 1>::Zero();
  padded.head<kParameters>() = o.jacobian;
  add_outer_21(information_.data(), padded.data(), weight);
  gradient_ += pull;
  weight_sum_ += o.robust_weight;
  residual_squares_ += o.robust_weight * o.residual * o.residual;
  ++count_;
  if (id >= clusters_.size()) clusters_.resize(id + 1);
  Cluster& cluster = clusters_[id];
  const double whitened = o.robust_weight * o.residual / o.sigma;
  cluster.gradient += pull;
  cluster.whitened_jacobian += o.robust_weight / o.sigma * o.jacobian;
  cluster.whitened_sum += whitened;
  cluster.whitened_squares += whitened * whitened;
}

void NormalEquations::merge(const NormalEquations& other) {
  information_ += other.information_;
  gradient_ += other.gradient_;
  weight_sum_ += other.weight_sum_;
  residual_squares_ += other.residual_squares_;
  count_ += other.count_;
  clusters_.insert(clusters_.end(), other.clusters_.begin(), other.clusters_.end());
}

NormalEquations NormalEquations::scaled(double factor) const {
  NormalEquations result = *this;
  result.information_ *= factor;
  result.gradient_ *= factor;
  for (Cluster& cluster : result.clusters_) cluster.gradient *= factor;
  return result;
}

double NormalEquations::rms_residual() const {
  return weight_sum_ > 0 ? std::sqrt(residual_squares_ / weight_sum_) : 0;
}

double NormalEquations::correlation_factor() const { return correlation_factor(ParameterVector::Zero()); }

double NormalEquations::correlation_factor(const ParameterVector& delta) const {
  double sums = 0, squares = 0;
  for (const Cluster& cluster : clusters_) {
    const double moved = cluster.whitened_sum - cluster.whitened_jacobian.dot(delta);
    sums += moved * moved;
    squares += cluster.whitened_squares;
  }
  return squares > 0 ? std::max(1.0, sums / squares) : 1.0;
}

ParameterMatrix NormalEquations::information() const {
  return information_.topRows<kParameters>().selfadjointView<Eigen::Lower>();
}

ParameterMatrix NormalEquations::cluster_scatter() const {
  ParameterMatrix scatter = ParameterMatrix::Zero();
  for (const Cluster& cluster : clusters_) scatter += cluster.gradient * cluster.gradient.transpose();
  return scatter;
}

}  // namespace calibrd
