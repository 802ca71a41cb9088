// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/cloud_registration.hpp"

#include <tbb/parallel_invoke.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/registration/cloud_pairs.hpp"
#include "core/registration/surface_cloud.hpp"
#include "core/registration/usable_points.hpp"

namespace calibrd {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// Noise tilts normals, and tilted normals pretend to hold what slides freely. True information must exceed
/// that of the tilt this many times.
constexpr double kOverFalseInformation = 3;

/// A cloud at both resolutions of the search.
struct Levels {
  float radius_m = 0;
  SurfaceCloud fine, coarse;
};

Levels levels_of(const Points& points, double neighbours) {
  constexpr std::size_t kCoarsePoints = 1000;  // they fix the pose to a fraction of the points' spacing
  Levels levels;
  levels.radius_m = neighbour_radius_m(points, neighbours);
  levels.fine = make_surface(points, levels.radius_m);
  const std::size_t step = points.size() / kCoarsePoints + 1;
  levels.coarse = thinned(levels.fine, step, levels.radius_m * std::sqrt(static_cast<float>(step)));
  return levels;
}

/// How far a partner may be.
struct Reach {
  float distance_m;
  float lateral_m;  // along the surface
};

/// Gauss-Newton on one resolution after the other.
class Search {
 public:
  Search(const CloudRegistrationSettings& settings, float least_sigma_m)
      : settings_(settings), least_sigma_m_(least_sigma_m) {}

  /// Goes on until a step is below `step_sigmas` of its uncertainty.
  Status run(const SurfaceCloud& source, const SurfaceCloud& target, const Reach& reach, double step_sigmas) {
    CloudPairs pairs(source, target);
    result_.converged = false;
    while (!result_.converged && result_.iterations < settings_.max_iterations) {
      pairs.match(result_.T_target_source, reach.distance_m, reach.lateral_m);
      const float sigma_m = std::max(pairs.sigma_m(), least_sigma_m_);
      const float kernel_m = static_cast<float>(settings_.kernel_sigmas) * sigma_m;
      result_.sigma_m = sigma_m;
      result_.overlap = pairs.overlap(kernel_m);
      if (result_.overlap < settings_.min_overlap)
        return fail(CloudRegistrationError::no_overlap, percent_of_overlap());
      if (!step(pairs.sums(kernel_m))) return fail(CloudRegistrationError::unobservable, "");
      ++result_.iterations;
      result_.converged = result_.last_step_sigmas < step_sigmas;
    }
    return Done{};
  }

  const CloudRegistration& result() const { return result_; }

 private:
  std::string percent_of_overlap() const {
    return std::to_string(std::lround(100 * result_.overlap)) + " % of the source agree with the target";
  }

  /// False where the pairs leave a direction open.
  bool step(const PairSums& sums) {
    // Rotations in units of the cloud's size, so that they compare with translations.
    const double turned = sums.information.topLeftCorner<3, 3>().trace();
    const double moved = sums.information.bottomRightCorner<3, 3>().trace();
    Vector6d unit = Vector6d::Ones();
    unit.head<3>().setConstant(std::sqrt(moved / turned));
    const Matrix6d information = unit.asDiagonal() * sums.information * unit.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information, Eigen::EigenvaluesOnly);
    const double least_information = kOverFalseInformation * sums.false_information + 1e-4 * sums.weight;
    if (!(eigen.eigenvalues()[0] > least_information)) return false;

    const Vector6d delta = unit.asDiagonal() * information.ldlt().solve(unit.asDiagonal() * sums.gradient);
    Pose motion = Pose::Identity();
    motion.linear() = exp_so3(delta.head<3>());
    motion.translation() = delta.tail<3>();
    result_.T_target_source = motion * result_.T_target_source;
    result_.last_step_sigmas = std::sqrt(delta.dot(sums.information * delta)) / result_.sigma_m;
    return true;
  }

  const CloudRegistrationSettings& settings_;
  float least_sigma_m_;
  CloudRegistration result_;
};

Result<CloudRegistration> register_levels(const Levels& source, const Levels& target,
                                          const CloudRegistrationSettings& settings) {
  const float radius_m = std::max(source.radius_m, target.radius_m);
  const auto max_distance_m = static_cast<float>(settings.max_distance_m);
  Search search(settings, 1e-4F * radius_m);  // clouds without noise: a sigma of 0 would weigh by 0/0
  constexpr double kCoarseStepSigmas = 1;
  if (auto went =
          search.run(source.coarse, target.coarse, {max_distance_m, max_distance_m}, kCoarseStepSigmas);
      !went)
    return went.error();
  // Now the surfaces lie on each other. Where the target goes on, its next point is almost never further away
  // along the surface than the radius that holds a dozen of them.
  const Reach reach{std::min(max_distance_m, 3 * radius_m), target.radius_m};
  if (auto went = search.run(source.fine, target.fine, reach, settings.convergence_sigmas); !went)
    return went.error();
  return search.result();
}

/// Clouds without a surface (a line, one point many times over) have no normals.
bool has_surface(const SurfaceCloud& cloud, std::size_t min_points) {
  const auto is_known = [](const Eigen::Vector3f& normal) { return !normal.isZero(0); };
  return static_cast<std::size_t>(std::ranges::count_if(cloud.normals, is_known)) >= min_points;
}

}  // namespace

Result<CloudRegistration> register_clouds(std::span<const Eigen::Vector3f> source,
                                          std::span<const Eigen::Vector3f> target,
                                          const CloudRegistrationSettings& settings) {
  // Turning about the source's own middle keeps rotation and translation apart.
  auto [reach, origin] = usable_extent(source);
  const Points from = usable_points(source, reach, origin, settings.max_points);
  if (from.size() < settings.min_points)
    return fail(CloudRegistrationError::too_few_points, "source, " + std::to_string(from.size()));
  // What the source cannot reach would only make the target's share of points sparser.
  reach.min().array() -= static_cast<float>(settings.max_distance_m);
  reach.max().array() += static_cast<float>(settings.max_distance_m);
  const Points to = usable_points(target, reach, origin, settings.max_points);
  if (to.size() < settings.min_points)
    return usable_extent(target).box.isEmpty()
               ? fail(CloudRegistrationError::too_few_points, "target, 0")
               : fail(CloudRegistrationError::no_overlap,
                      std::to_string(to.size()) + " points of the target are near the source");

  Levels source_levels, target_levels;
  tbb::parallel_invoke([&] { source_levels = levels_of(from, settings.neighbours); },
                       [&] { target_levels = levels_of(to, settings.neighbours); });
  for (const Levels* levels : {&source_levels, &target_levels})
    if (!has_surface(levels->fine, settings.min_points))
      return fail(CloudRegistrationError::unobservable, "the points lie on no surface");

  auto result = register_levels(source_levels, target_levels, settings);
  if (!result) return result;
  const Eigen::Translation3d T_cloud_centred(origin.cast<double>());
  result->T_target_source = T_cloud_centred * result->T_target_source * T_cloud_centred.inverse();
  return result;
}

}  // namespace calibrd
