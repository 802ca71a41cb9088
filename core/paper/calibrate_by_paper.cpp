// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/calibrate_by_paper.hpp"

#include "core/paper/paper_error.hpp"
#include "core/paper/paper_method.hpp"

namespace calibrd {

CalibrationResult calibrate_by_paper(const RobotModel& robot, const CameraModel& camera,
                                     std::span<const View> views, const CalibrationSettings& settings) {
  CalibrationResult result;
  result.used_guess = settings.guess_T_base_sensor.has_value();
  result.views = 1;
  if (!settings.guess_T_base_sensor) {
    result.reasons.push_back({"guess_needed", "the paper's method needs a rough pose to start from"});
    return result;
  }
  const auto fit = fit_by_paper(robot, camera, views.front(), *settings.guess_T_base_sensor, settings.paper);
  if (!fit) {
    result.reasons.push_back({paper_error_name(fit.error()), fit.error().message()});
    return result;
  }
  result.verdict = Verdict::uncertain;
  result.T_base_sensor = fit->T_base_sensor;
  result.residual_rms_m = fit->rms_m;
  result.reasons.push_back(
      {"paper_method", "the paper's method gives no uncertainty; its pose is for comparison only"});
  if (!fit->converged)
    result.reasons.push_back({"not_converged", "ICP ended before its correspondences settled"});
  if (views.size() > 1)
    result.reasons.push_back({"first_view_only", "the paper's method uses one posture: the first view"});
  return result;
}

}  // namespace calibrd
