// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/paper_method.hpp"

#include "core/paper/paper_error.hpp"
#include "core/paper/pcl_module.hpp"
#include "core/paper/virtual_clouds.hpp"

namespace calibrd {

Result<PaperFit> fit_by_paper(const RobotModel& robot, const CameraModel& camera, const View& view,
                              const Pose& guess_T_base_sensor, const PaperSettings& settings) {
  const Pose& T_base_virtual = guess_T_base_sensor;
  const Points model_base = settings.sampling == PaperSampling::uniform
                                ? sampled_uniformly(robot, view, settings)
                                : seen_by_three_sensors(robot, camera, view, T_base_virtual);
  const Points model = moved(T_base_virtual.inverse(), model_base);
  const Region region = settings.region_sensor
                            ? Region{Pose::Identity(), *settings.region_sensor}
                            : Region{T_base_virtual, region_of_robot(model_base, settings.region_margin_m)};
  const Points measured = measured_in(region, camera, view);
  if (measured.size() < kFewestPoints || model.size() < kFewestPoints)
    return fail(PaperError::robot_not_found);

  const auto aligned = align_by_pcl(measured, model, settings);
  if (!aligned) return aligned.error();
  return PaperFit{T_base_virtual * aligned->T_virtual_real, aligned->converged, aligned->rms_m,
                  aligned->measured_points, aligned->model_points};
}

}  // namespace calibrd
