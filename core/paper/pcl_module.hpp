// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.hpp"
#include "core/geometry/pose.hpp"
#include "core/paper/paper_settings.hpp"
#include "core/paper/virtual_clouds.hpp"

namespace calibrd {

struct AlignedClouds {
  Pose T_virtual_real = Pose::Identity();
  bool converged = false;
  double rms_m = 0;
  std::size_t measured_points = 0, model_points = 0;  ///< after down-sampling
};

/// Down-samples both clouds and aligns the measured one with the model by PCL, which is loaded on the first
/// call from ../lib/calibrd beside the running program's folder, and stays. Safe to call from any thread.
/// Errors: pcl_missing, pcl_failed.
Result<AlignedClouds> align_by_pcl(const Points& measured, const Points& model,
                                   const PaperSettings& settings);

}  // namespace calibrd
