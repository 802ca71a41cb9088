// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/image_registration.hpp"
#include "core/registration/refine.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

/// How the measurement treats what is predicted: pixels of one link or of one view.
struct SurfaceTally {
  std::size_t predicted = 0;
  std::size_t measured = 0;
  std::size_t agreeing = 0;
  std::size_t seen_through = 0;  ///< the measurement lies behind: this is not where the surface is
  std::size_t occluded = 0;      ///< something stands in front
  void merge(const SurfaceTally& other);
};

/// What speaks for and against a pose beyond the residuals that it was fitted to.
struct Evidence {
  std::vector<SurfaceTally> links;  ///< as RobotModel::links()
  std::vector<SurfaceTally> views;
  /// Per view, how far (m, rms along the rays) the robot's surface would move if the joints of this view
  /// alone were free. Large where the joints are not those of the frame.
  std::vector<double> joint_pull_m;
  /// Median |residual| (m) of views judged by the pose of the other views; nothing below 4 views.
  std::optional<double> held_out_residual_m;
  ImageRegistration images;
  Eigen::Vector3d robot_middle_base = Eigen::Vector3d::Zero();  ///< of the visible surface
};

/// Looks at all views from where the refinement ended. `views` must be as refine() left them.
Evidence gather_evidence(std::span<const RegistrationView> views, const CameraModel& camera,
                         const Refinement& refined);

/// The pose of the true base: refine() gives the one that is right for the joints as reported.
Pose pose_of_true_base(std::span<const RegistrationView> views, const CameraModel& camera,
                       const Refinement& refined);

}  // namespace calibrd
