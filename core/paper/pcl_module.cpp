// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/pcl_module.hpp"

#include <dlfcn.h>

#include <filesystem>

#include "core/paper/paper_error.hpp"
#include "core/paper/pcl/pcl_entry.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float), "clouds cross as x, y, z triples");

Error missing(const std::string& what) {
  const char* why = dlerror();
  return fail(PaperError::pcl_missing, why != nullptr ? why : what);
}

/// RTLD_LOCAL: what PCL brings is seen by PCL alone, above all its Boost, which is not ours on Debian 12.
Result<CalibrdPclAlign> load() {
  std::error_code ignored;
  const fs::path bin = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::string path = (bin.parent_path() / kPclModulePath).string();
  void* module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) return missing(path);
  void* entry = dlsym(module, kPclEntryName);
  if (entry == nullptr) return missing(path);
  return reinterpret_cast<CalibrdPclAlign>(entry);
}

const float* values(const Points& points) { return points.front().data(); }

}  // namespace

Result<AlignedClouds> align_by_pcl(const Points& measured, const Points& model,
                                   const PaperSettings& settings) {
  static const Result<CalibrdPclAlign> align = load();
  if (!align) return align.error();
  if (measured.empty() || model.empty()) return fail(PaperError::pcl_failed);
  CalibrdPclTask task;
  task.measured = values(measured);
  task.measured_count = measured.size();
  task.model = values(model);
  task.model_count = model.size();
  task.voxel_m = settings.voxel_m;
  task.max_correspondence_m = settings.max_correspondence_m;
  task.transformation_epsilon = settings.transformation_epsilon;
  task.max_iterations = settings.max_iterations;
  CalibrdPclFit fit;
  if (!(*align)(&task, &fit)) return fail(PaperError::pcl_failed);
  AlignedClouds aligned;
  aligned.T_virtual_real.matrix() =
      Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>{fit.T_virtual_real};
  aligned.converged = fit.converged;
  aligned.rms_m = fit.rms_m;
  aligned.measured_points = fit.measured_points;
  aligned.model_points = fit.model_points;
  return aligned;
}

}  // namespace calibrd
