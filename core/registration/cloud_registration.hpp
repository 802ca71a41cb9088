// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>

#include "core/geometry/pose.hpp"
#include "core/registration/cloud_registration_error.hpp"

namespace calibrd {

struct CloudRegistrationSettings {
  double max_distance_m = 0.1;     ///< points further apart are no pair, from the first step on
  double neighbours = 12;          ///< that a normal is estimated from, on average
  std::size_t min_points = 50;     ///< usable ones, of each cloud
  std::size_t max_points = 20000;  ///< of each cloud; larger ones are thinned to this
  double kernel_sigmas = 8;        ///< pairs further off than this many sigmas have no weight (Tukey)
  double min_overlap = 0.1;        ///< share of the source that must agree with the target
  /// A step this small against its own uncertainty ends the search.
  double convergence_sigmas = 0.2;
  int max_iterations = 50;
};

/// Where the source lies in the target's frame and what speaks for it.
struct CloudRegistration {
  Pose T_target_source = Pose::Identity();
  bool converged = false;  ///< false: max_iterations came first
  int iterations = 0;
  double overlap = 0;           ///< share of the source's points that agree with the target's surface
  double sigma_m = 0;           ///< robust standard deviation of their distances from it
  double last_step_sigmas = 0;  ///< length of the last step against the uncertainty of the result
};

/// Rigid registration of two clouds that overlap in part and start within some centimetres and degrees of
/// each other: Gauss-Newton on the distances of nearest neighbours along the mean of both normals (the
/// symmetric objective of Rusinkiewicz 2019: noise in either cloud does the same harm), first on thinned
/// clouds, then on all points; a redescending kernel leaves out what only one of them shows. Points that are
/// not finite, or further than 100 km off, are left out. Deterministic. Thread-safe.
/// Errors: CloudRegistrationError.
Result<CloudRegistration> register_clouds(std::span<const Eigen::Vector3f> source,
                                          std::span<const Eigen::Vector3f> target,
                                          const CloudRegistrationSettings& settings);

}  // namespace calibrd
