// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace calibrd {

/// How the virtual measurement is made.
enum class PaperSampling {
  uniform,        ///< points spread over the whole CAD surface, hidden ones too (section IV.B)
  three_sensors,  ///< what three virtual sensors around the robot see, together (section V, figure 5)
};

/// The published method's choices. It states none of its numbers; docs/paper.md says where these come from.
struct PaperSettings {
  PaperSampling sampling = PaperSampling::uniform;
  /// Region of interest, sensor frame, m. Nothing: the robot's bounding box at the guess, widened.
  std::optional<Eigen::AlignedBox3d> region_sensor;
  double region_margin_m = 0.1;       ///< how far that box is widened
  std::size_t model_points = 100000;  ///< uniform samples, as many as PCL's mesh_sampling makes
  double voxel_m = 0.01;              ///< down-sampling of both clouds: mesh_sampling's leaf
  double max_correspondence_m = 0.1;
  int max_iterations = 200;
  double transformation_epsilon = 1e-9;  ///< PCL: squared step (m²) and 1 - cos of the turn that end it
  std::uint64_t seed = 1;
};

}  // namespace calibrd
