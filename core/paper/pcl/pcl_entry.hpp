// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

/// What crosses into the shared object libcalibrd_pcl.so and back: plain numbers only, so that neither side
/// needs the other's C++ library, Eigen or Boost. Clouds are x, y, z triples, m.
extern "C" {

struct CalibrdPclTask {
  const float* measured = nullptr;  ///< 3 * measured_count values, virtual sensor's frame
  std::size_t measured_count = 0;
  const float* model = nullptr;  ///< 3 * model_count values, virtual sensor's frame
  std::size_t model_count = 0;
  double voxel_m = 0;
  double max_correspondence_m = 0;
  double transformation_epsilon = 0;
  int max_iterations = 0;
};

struct CalibrdPclFit {
  double T_virtual_real[16] = {};                     ///< row-major; maps measured points onto the model
  double rms_m = 0;                                   ///< of the distances of correspondences
  std::size_t measured_points = 0, model_points = 0;  ///< left after down-sampling
  bool converged = false;                             ///< as PCL understands it
};

/// Down-samples both clouds (VoxelGrid) and aligns them (IterativeClosestPoint, its SVD). False when PCL
/// failed or found too few correspondences. Throws nothing; safe to call from several threads.
[[gnu::visibility("default")]] bool calibrd_pcl_align_1(const CalibrdPclTask* task,
                                                        CalibrdPclFit* fit) noexcept;
using CalibrdPclAlign = bool (*)(const CalibrdPclTask*, CalibrdPclFit*) noexcept;

}  // extern "C"

namespace calibrd {
inline constexpr const char* kPclEntryName = "calibrd_pcl_align_1";  ///< its number grows with the structs
inline constexpr const char* kPclModulePath = "lib/calibrd/libcalibrd_pcl.so";  ///< beside the programs' bin/
}  // namespace calibrd
