// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/paper_method.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>

#include "core/registration/cloud_tree.hpp"
#include "core/virtual_cell/surface_sampling.hpp"

namespace calibrd {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// One point, their mean, for all points of a cubic cell.
Points thinned(const Points& points, double voxel_m) {
  struct Cell {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
  };
  std::map<std::array<long, 3>, Cell> cells;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Array3d index = (p.array() / voxel_m).floor();
    Cell& cell =
        cells[{static_cast<long>(index.x()), static_cast<long>(index.y()), static_cast<long>(index.z())}];
    cell.sum += p;
    ++cell.count;
  }
  Points thin;
  for (const auto& [index, cell] : cells) thin.emplace_back(cell.sum / cell.count);
  return thin;
}

/// The virtual measurement: CAD points in the virtual sensor's frame. Fills `region`, in the base frame.
Points model_points(const RobotModel& robot, const View& view, const Pose& T_base_virtual,
                    const PaperSettings& settings, Eigen::AlignedBox3d& region) {
  Points points;
  const Pose T_virtual_base = T_base_virtual.inverse();
  for (const SurfaceSample& sample :
       sample_surface(robot, view.joint_positions_rad, settings.model_points, settings.seed)) {
    region.extend(sample.point);
    points.emplace_back(T_virtual_base * sample.point);
  }
  return points;
}

Points measured_points(const CameraModel& camera, const View& view, const Pose& T_base_virtual,
                       const Eigen::AlignedBox3d& region) {
  Points points;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double z = view.depth.depth_m(x, y);
      if (z <= 0) continue;
      const Eigen::Vector3d p_sensor = z * camera.ray(x, y);
      if (region.contains(T_base_virtual * p_sensor)) points.push_back(p_sensor);
    }
  }
  return points;
}

struct Matches {
  Eigen::Matrix3Xd measured, model;
  double rms_m = 0;
};

/// Eq. 1: for every measured point, moved by the transform so far, the nearest model point.
Matches match(const Points& measured, const CloudTree& model, const Pose& T_virtual_real,
              double max_distance_m) {
  Points from, to;
  double squares = 0;
  for (const Eigen::Vector3d& p : measured) {
    const auto neighbour = model.nearest(T_virtual_real * p);
    if (!neighbour || neighbour->distance_m > max_distance_m) continue;
    from.push_back(p);
    to.push_back(neighbour->point);
    squares += neighbour->distance_m * neighbour->distance_m;
  }
  const auto count = static_cast<Eigen::Index>(from.size());
  Matches matches{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count), 0};
  for (Eigen::Index i = 0; i < count; ++i) {
    matches.measured.col(i) = from[static_cast<std::size_t>(i)];
    matches.model.col(i) = to[static_cast<std::size_t>(i)];
  }
  if (count > 0) matches.rms_m = std::sqrt(squares / static_cast<double>(count));
  return matches;
}

}  // namespace

std::optional<PaperFit> fit_by_paper(const RobotModel& robot, const CameraModel& camera, const View& view,
                                     const Pose& guess_T_base_sensor, const PaperSettings& settings) {
  Eigen::AlignedBox3d region;
  const Points all = model_points(robot, view, guess_T_base_sensor, settings, region);
  if (all.empty()) return std::nullopt;
  region.min().array() -= settings.region_margin_m;
  region.max().array() += settings.region_margin_m;
  std::vector<Eigen::Vector3f> thin_model;
  for (const Eigen::Vector3d& p : thinned(all, settings.voxel_m)) thin_model.emplace_back(p.cast<float>());
  const CloudTree model(std::move(thin_model));
  const Points measured =
      thinned(measured_points(camera, view, guess_T_base_sensor, region), settings.voxel_m);

  PaperFit fit;
  fit.points = measured.size();
  Pose T_virtual_real = Pose::Identity();
  for (int i = 0; i < settings.max_iterations && !fit.converged; ++i) {
    const Matches matches = match(measured, model, T_virtual_real, settings.max_correspondence_m);
    if (matches.measured.cols() < 10) return std::nullopt;
    // Eq. 2 to 6 with the directions put right: SVD on matched pairs, centred on their own centroids.
    const Pose next(Eigen::umeyama(matches.measured, matches.model, false));
    fit.converged = (next.matrix() - T_virtual_real.matrix()).squaredNorm() < settings.transformation_epsilon;
    fit.rms_m = matches.rms_m;
    T_virtual_real = next;
  }
  fit.T_base_sensor = guess_T_base_sensor * T_virtual_real;
  return fit;
}

}  // namespace calibrd
