// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/usable_views.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace calibrd {
namespace {

bool is_empty(const View& view) {
  return !view.depth.raw.empty() &&
         std::ranges::all_of(view.depth.raw, [](std::uint16_t raw) { return raw == 0; });
}

}  // namespace

std::optional<Reason> unusable(const RobotModel& robot, const CameraModel& camera,
                               std::span<const View> views) {
  if (views.empty())
    return Reason{"no_views", "there is no view to calibrate from; record at least one posture"};
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& view = views[i];
    const std::string name = "view " + std::to_string(i);
    if (view.depth.width != camera.width || view.depth.height != camera.height ||
        view.depth.raw.size() != pixels)
      return Reason{"wrong_image_size", name + ": the depth image has not the size of the camera model"};
    if (view.image && (view.image->width != camera.width || view.image->height != camera.height ||
                       view.image->pixels.size() != pixels))
      return Reason{"wrong_image_size", name + ": the image has not the size of the camera model"};
    if (view.joint_positions_rad.size() != robot.position_count())
      return Reason{"wrong_joint_count", name + ": the robot model needs " +
                                             std::to_string(robot.position_count()) + " joint positions"};
    if (!std::ranges::all_of(view.joint_positions_rad, [](double q) { return std::isfinite(q); }))
      return Reason{"joint_not_finite", name + ": a joint position is not a finite number"};
    if (is_empty(view))
      return Reason{"empty_frame", name + ": the depth image holds no measurement; is the sensor covered?"};
  }
  return std::nullopt;
}

std::vector<View> without_empty(std::span<const View> views) {
  constexpr std::ptrdiff_t kLeastLeft = 4;
  std::vector<View> seen;
  const std::ptrdiff_t empty = std::ranges::count_if(views, is_empty);
  if (empty == 0 || std::ssize(views) - empty < kLeastLeft) return seen;
  std::ranges::copy_if(views, std::back_inserter(seen), [](const View& view) { return !is_empty(view); });
  return seen;
}

}  // namespace calibrd
