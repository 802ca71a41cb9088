// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/pcl/pcl_entry.hpp"

#include <pcl/console/print.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/icp.h>

#include <cmath>

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Icp = pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, double>;
using Criteria = pcl::registration::DefaultConvergenceCriteria<double>;

Cloud::Ptr thinned(const float* xyz, std::size_t count, double voxel_m) {
  const Cloud::Ptr cloud(new Cloud), thin(new Cloud);
  cloud->reserve(count);
  for (std::size_t i = 0; i < count; ++i) cloud->emplace_back(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  const auto leaf = static_cast<float>(voxel_m);
  grid.setLeafSize(leaf, leaf, leaf);
  grid.setInputCloud(cloud);
  grid.filter(*thin);
  return thin;
}

void align(const CalibrdPclTask& task, CalibrdPclFit& fit) {
  const Cloud::Ptr measured = thinned(task.measured, task.measured_count, task.voxel_m);
  const Cloud::Ptr model = thinned(task.model, task.model_count, task.voxel_m);
  Icp icp;
  icp.setInputSource(measured);
  icp.setInputTarget(model);
  icp.setMaxCorrespondenceDistance(task.max_correspondence_m);
  icp.setMaximumIterations(task.max_iterations);
  icp.setTransformationEpsilon(task.transformation_epsilon);
  Cloud aligned;
  icp.align(aligned);
  fit.measured_points = measured->size();
  fit.model_points = model->size();
  fit.converged =
      icp.hasConverged() &&  // which PCL says as well when it has only used up its iterations
      icp.getConvergeCriteria()->getConvergenceState() != Criteria::CONVERGENCE_CRITERIA_ITERATIONS;
  // PCL compares its argument with squared distances.
  fit.rms_m = std::sqrt(icp.getFitnessScore(task.max_correspondence_m * task.max_correspondence_m));
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>{fit.T_virtual_real} = icp.getFinalTransformation();
}

}  // namespace

bool calibrd_pcl_align_1(const CalibrdPclTask* task, CalibrdPclFit* fit) noexcept {
  try {
    // What failed is returned, not printed. Once: PCL keeps this in a global variable.
    [[maybe_unused]] static const bool silenced =
        (pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS), true);
    align(*task, *fit);
    return std::isfinite(fit->rms_m) && fit->rms_m <= task->max_correspondence_m;
  } catch (...) {  // nothing may be thrown out of a shared object with another C++ library's view of types
    return false;
  }
}
