// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/paper_method.hpp"

#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/icp.h>

#include "core/virtual_cell/surface_sampling.hpp"

namespace calibrd {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

pcl::PointXYZ to_pcl(const Eigen::Vector3d& p) {
  const Eigen::Vector3f f = p.cast<float>();
  return {f.x(), f.y(), f.z()};
}

Cloud::Ptr thinned(const Cloud::Ptr& cloud, double voxel_m) {
  const auto leaf = static_cast<float>(voxel_m);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(cloud);
  grid.setLeafSize(leaf, leaf, leaf);
  Cloud::Ptr thin(new Cloud);
  grid.filter(*thin);
  return thin;
}

/// The virtual measurement: CAD points in the virtual sensor's frame. Fills `region` in the base frame.
Cloud::Ptr model_cloud(const RobotModel& robot, const View& view, const Pose& T_base_virtual,
                       const PaperSettings& settings, Eigen::AlignedBox3d& region) {
  Cloud::Ptr cloud(new Cloud);
  const Pose T_virtual_base = T_base_virtual.inverse();
  for (const SurfaceSample& sample :
       sample_surface(robot, view.joint_positions_rad, settings.model_points, settings.seed)) {
    region.extend(sample.point);
    cloud->push_back(to_pcl(T_virtual_base * sample.point));
  }
  return cloud;
}

Cloud::Ptr measured_cloud(const CameraModel& camera, const View& view, const Pose& T_base_virtual,
                          const Eigen::AlignedBox3d& region) {
  Cloud::Ptr cloud(new Cloud);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double z = view.depth.depth_m(x, y);
      if (z <= 0) continue;
      const Eigen::Vector3d p_sensor = z * camera.ray(x, y);
      if (region.contains(T_base_virtual * p_sensor)) cloud->push_back(to_pcl(p_sensor));
    }
  }
  return cloud;
}

}  // namespace

std::optional<PaperFit> fit_by_paper(const RobotModel& robot, const CameraModel& camera, const View& view,
                                     const Pose& guess_T_base_sensor, const PaperSettings& settings) {
  Eigen::AlignedBox3d region;
  const Cloud::Ptr model =
      thinned(model_cloud(robot, view, guess_T_base_sensor, settings, region), settings.voxel_m);
  if (model->empty()) return std::nullopt;
  region.min().array() -= settings.region_margin_m;
  region.max().array() += settings.region_margin_m;
  const Cloud::Ptr measured =
      thinned(measured_cloud(camera, view, guess_T_base_sensor, region), settings.voxel_m);
  if (measured->size() < 10) return std::nullopt;

  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setInputSource(measured);
  icp.setInputTarget(model);
  icp.setMaxCorrespondenceDistance(settings.max_correspondence_m);
  icp.setMaximumIterations(settings.max_iterations);
  icp.setTransformationEpsilon(settings.transformation_epsilon);
  Cloud aligned;
  icp.align(aligned);

  PaperFit fit;
  fit.converged = icp.hasConverged();
  fit.rms_m = std::sqrt(icp.getFitnessScore(settings.max_correspondence_m));
  fit.points = measured->size();
  Pose T_virtual_real = Pose::Identity();
  const Eigen::Matrix4d matrix = icp.getFinalTransformation().cast<double>();
  T_virtual_real.linear() = Eigen::Quaterniond(matrix.topLeftCorner<3, 3>()).normalized().toRotationMatrix();
  T_virtual_real.translation() = matrix.topRightCorner<3, 1>();
  fit.T_base_sensor = guess_T_base_sensor * T_virtual_real;
  return fit;
}

}  // namespace calibrd
