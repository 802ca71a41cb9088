// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cross_check/cross_check.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/calibration/check_pose.hpp"
#include "core/cross_check/range_error.hpp"
#include "core/registration/linearization.hpp"

namespace calibrd {
namespace {

constexpr double kFirstKernel_m = 0.1, kLeastKernel_m = 0.012, kKernelSigmas = 4.7;
constexpr double kTypicalSigma_m = 2e-3;
constexpr int kSteps = 12;
constexpr double kMinCosine = 0.85;  // between the normals of a pair: what the sensors see of an edge differs
constexpr std::size_t kLeastPairs = 300;
/// No direction is known worse than this before, so that none along which the surfaces slide runs away.
constexpr double kVague_rad = 0.05, kVague_m = 0.05;
/// Errors that do not average out, of each: bumps and wiggles that neither model has, joint zeros.
constexpr double kFloor_m = 1e-3, kFloor_rad = 1e-3;
/// Cells of one square of this side share what correlates.
constexpr int kClusterSide = 6;

/// A cell of the second sensor's background that has a plane; base frame, as its pose has it.
struct Point {
  Eigen::Vector3d p_base, normal_base, direction_base;  // direction: of its viewing ray, z = 1 in its sensor
  double sigma_m;                                       // along the normal
  RangeError::Place range;
  std::size_t cluster;
};

Eigen::Vector3d true_normal(const BackgroundCell& cell) {
  return cell.normal_per_m.cast<double>().normalized();
}

RangeError range_error_of(const CheckedSensor& sensor) {
  double least_m = std::numeric_limits<double>::max(), most_m = 0;
  for (const BackgroundCell& cell : sensor.background.cells()) {
    if (!cell.has_plane()) continue;
    least_m = std::min<double>(least_m, cell.depth_m);
    most_m = std::max<double>(most_m, cell.depth_m);
  }
  return {std::min(least_m, most_m), most_m, sensor.T_base_sensor.inverse().translation().z()};
}

std::vector<Point> points_of(const CheckedSensor& sensor, const RangeError& range) {
  std::vector<Point> points;
  const CameraModel& grid = sensor.background.grid();
  const auto per_row = static_cast<std::size_t>((grid.width - 1) / kClusterSide + 1);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const BackgroundCell& cell = sensor.background.cells()[static_cast<std::size_t>(y * grid.width + x)];
      if (!cell.has_plane()) continue;
      const Eigen::Vector3d ray = sensor.background.rays().at(x, y), normal = true_normal(cell);
      points.push_back({sensor.T_base_sensor * (sensor.correction.truth(cell.depth_m) * ray),
                        sensor.T_base_sensor.linear() * normal, sensor.T_base_sensor.linear() * ray,
                        cell.sigma_m * std::abs(normal.dot(ray)), range.at(cell.depth_m),
                        static_cast<std::size_t>(y / kClusterSide) * per_row +
                            static_cast<std::size_t>(x / kClusterSide)});
    }
  return points;
}

class Comparison {
 public:
  Comparison(const CheckedSensor& first, const CheckedSensor& second)
      : first_(first),
        T_first_base_(first.T_base_sensor.inverse()),
        first_range_(range_error_of(first)),
        second_range_(range_error_of(second)),
        points_(points_of(second, second_range_)),
        size_(6 + first_range_.knots() + second_range_.knots()),
        at_(Eigen::VectorXd::Zero(size_)) {}

  CrossCheck run() {
    CrossCheck check;
    if (points_.empty() || first_.background.is_empty()) return check;
    for (const Point& point : points_) middle_ += point.p_base / static_cast<double>(points_.size());
    center_on_overlap();
    const Eigen::MatrixXd prior = prior_information();
    double kernel_m = kFirstKernel_m;
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(size_, size_);
    for (int step = 0; step < kSteps; ++step) {
      collect(kernel_m);
      if (used_ < kLeastPairs) break;
      const double scatter = std::max(1.0, robust_sigma(whitened_)), correlation = clustering();
      const double worth = 1 / (scatter * scatter * correlation);
      const Eigen::LDLT<Eigen::MatrixXd> solver(worth * information_ + prior);
      at_ += solver.solve(worth * gradient_ - prior * at_);
      covariance = solver.solve(Eigen::MatrixXd::Identity(size_, size_));
      kernel_m = std::clamp(std::max(kKernelSigmas * scatter * kTypicalSigma_m, 0.6 * kernel_m),
                            kLeastKernel_m, kFirstKernel_m);
    }
    check.pairs = used_;
    check.seen_through = seen_through_;
    check.middle_base = middle_;
    check.has_overlap = used_ >= kLeastPairs || seen_through_ > kLeastPairs;
    check.turn_shift = at_.head<6>();
    check.covariance = covariance.topLeftCorner<6, 6>();
    return check;
  }

 private:
  /// The plane of the first that a point lies over, if any.
  struct Partner {
    Eigen::Vector3d normal_base, direction_base;
    double distance_m, depth_behind_m, sigma_m;
    RangeError::Place range;
  };

  std::optional<Partner> partner(const Eigen::Vector3d& p_base, const Eigen::Vector3d& normal_base) const {
    const CameraModel& grid = first_.background.grid();
    const Eigen::Vector3d p = T_first_base_ * p_base;
    if (p.z() < 0.1) return std::nullopt;
    const Eigen::Vector2d pixel = grid.project(p);
    if (!(pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < grid.width - 0.5 &&
          pixel.y() < grid.height - 0.5))
      return std::nullopt;
    const auto x = std::lround(pixel.x()), y = std::lround(pixel.y());
    const BackgroundCell& cell = first_.background.cells()[static_cast<std::size_t>(y * grid.width + x)];
    if (!cell.has_plane()) return std::nullopt;
    const Eigen::Vector3d d = p / p.z(), n = true_normal(cell);
    const double z = first_.correction.truth(1 / cell.normal_per_m.cast<double>().dot(d)), along = n.dot(d);
    const Eigen::Vector3d n_base = first_.T_base_sensor.linear() * n;
    if (z - p.z() < kFirstKernel_m && n_base.dot(normal_base) < kMinCosine) return std::nullopt;
    return Partner{n_base,    first_.T_base_sensor.linear() * d, (p.z() - z) * along,
                   z - p.z(), cell.sigma_m * std::abs(along),    first_range_.at(cell.depth_m)};
  }

  Eigen::MatrixXd prior_information() const {
    Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(size_, size_);
    prior.diagonal().head<3>().setConstant(1 / (kVague_rad * kVague_rad));
    prior.diagonal().segment<3>(3).setConstant(1 / (kVague_m * kVague_m));
    prior.block(6, 6, first_range_.knots(), first_range_.knots()) = first_range_.precision();
    prior.bottomRightCorner(second_range_.knots(), second_range_.knots()) = second_range_.precision();
    return prior;
  }

  /// The range error that is assumed by now, m; `first_knot`: where the sensor's begin among the parameters.
  double range_error(const RangeError::Place& place, Eigen::Index first_knot) const {
    return (1 - place.share) * at_[first_knot + place.index] +
           place.share * at_[first_knot + place.index + 1];
  }

  Eigen::Vector3d moved(const Point& point) const {
    const Eigen::Vector3d p =
        point.p_base + range_error(point.range, 6 + first_range_.knots()) * point.direction_base;
    return middle_ + exp_so3(at_.head<3>()) * (p - middle_) + at_.segment<3>(3);
  }

  /// Turns are about the middle of what both see.
  void center_on_overlap() {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (const Point& point : points_) {
      const auto found = partner(point.p_base, point.normal_base);
      if (!found || std::abs(found->distance_m) > kFirstKernel_m) continue;
      sum += point.p_base;
      ++count;
    }
    if (count > 0) middle_ = sum / count;
  }

  void collect(double kernel_m) {
    information_ = Eigen::MatrixXd::Zero(size_, size_);
    gradient_ = Eigen::VectorXd::Zero(size_);
    used_ = seen_through_ = 0;
    whitened_.clear();
    pulls_.clear();
    squares_ = 0;
    const Eigen::Matrix3d turn = exp_so3(at_.head<3>());
    for (const Point& point : points_) {
      const Eigen::Vector3d p = moved(point);
      const auto found = partner(p, turn * point.normal_base);
      if (!found) continue;
      if (found->depth_behind_m > kFirstKernel_m) ++seen_through_;
      const double along = found->normal_base.dot(found->direction_base);
      const double residual = found->distance_m - along * range_error(found->range, 6),
                   off = residual / kernel_m;
      if (std::abs(off) >= 1) continue;
      add(point, *found, p, residual, (1 - off * off) * (1 - off * off));
    }
  }

  void add(const Point& point, const Partner& found, const Eigen::Vector3d& p, double residual,
           double robust) {
    const double sigma = std::hypot(found.sigma_m, point.sigma_m), weight = robust / (sigma * sigma);
    const double along = found.normal_base.dot(found.direction_base),
                 across = -found.normal_base.dot(point.direction_base);
    // The residual falls by slope[i] times the change of parameter at[i]: all others have no part in it.
    const Eigen::Index first = 6 + found.range.index, second = 6 + first_range_.knots() + point.range.index;
    const std::array<Eigen::Index, 10> at{0, 1, 2, 3, 4, 5, first, first + 1, second, second + 1};
    Eigen::Matrix<double, 10, 1> slope;
    slope << -(p - middle_).cross(found.normal_base), -found.normal_base, (1 - found.range.share) * along,
        found.range.share * along, (1 - point.range.share) * across, point.range.share * across;
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double weighted = weight * slope[static_cast<Eigen::Index>(i)];
      gradient_[at[i]] += weighted * residual;
      for (std::size_t j = 0; j < at.size(); ++j)
        information_(at[i], at[j]) += weighted * slope[static_cast<Eigen::Index>(j)];
    }
    whitened_.push_back(static_cast<float>(residual / sigma));
    const double pull = robust * residual / sigma;
    if (point.cluster >= pulls_.size()) pulls_.resize(point.cluster + 1, 0.0);
    pulls_[point.cluster] += pull;
    squares_ += pull * pull;
    ++used_;
  }

  /// Times that errors are less independent than their number says.
  double clustering() const {
    double sum = 0;
    for (const double pull : pulls_) sum += pull * pull;
    return std::max(1.0, sum / squares_);
  }

  const CheckedSensor& first_;
  const Pose T_first_base_;
  const RangeError first_range_, second_range_;
  const std::vector<Point> points_;
  const Eigen::Index size_;  ///< turn and shift of the second, range errors of the first, of the second
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  Eigen::VectorXd at_, gradient_;
  Eigen::MatrixXd information_;
  std::vector<float> whitened_;
  std::vector<double> pulls_;
  double squares_ = 0;
  std::size_t used_ = 0, seen_through_ = 0;
};

/// What both poses leave open of how the second lies to the first, as turn and shift of `middle_base`.
Matrix6d expected_covariance(const CheckedSensor& first, const CheckedSensor& second,
                             const Eigen::Vector3d& middle_base) {
  Matrix6d sum = Matrix6d::Zero();
  for (const CheckedSensor* sensor : {&first, &second}) {
    const Matrix6d move = shift_of_point(middle_base - sensor->T_base_sensor.translation());
    sum += move * sensor->covariance * move.transpose();
  }
  sum.diagonal().head<3>().array() += kFloor_rad * kFloor_rad;
  sum.diagonal().tail<3>().array() += kFloor_m * kFloor_m;
  return sum;
}

}  // namespace

CrossCheck cross_check(const CheckedSensor& first, const CheckedSensor& second) {
  CrossCheck check = Comparison(first, second).run();
  if (!check.has_overlap) return check;
  if (check.seen_through > check.pairs) {  // nothing near makes the two fit
    check.sigmas = std::numeric_limits<double>::infinity();
    return check;
  }
  const Matrix6d expected = expected_covariance(first, second, check.middle_base) + check.covariance;
  check.sigmas = std::sqrt(check.turn_shift.dot(expected.ldlt().solve(check.turn_shift)) / 6);
  check.turn_rad = check.turn_shift.head<3>().norm();
  check.shift_m = check.turn_shift.tail<3>().norm();
  return check;
}

}  // namespace calibrd
