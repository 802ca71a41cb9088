// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/capture_rules.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>

#include "core/capture/capture_error.hpp"

namespace calibrd {
namespace {

constexpr int kMinSide = 8, kMaxSide = 8192;
constexpr double kMinDepthScale_m = 1e-6, kMaxDepthScale_m = 0.1;
constexpr std::uint64_t kMaxPixels = 1'000'000'000;  // of all depth images: 2 GB

template <class Value>
Error bad(const char* key, Value value, const char* expected) {
  std::ostringstream text;
  text << key << " (" << value << "; expected " << expected << ")";
  return fail(CaptureError::bad_value, text.str());
}

bool is_side(int pixels) { return pixels >= kMinSide && pixels <= kMaxSide; }
bool is_positive(double value) { return std::isfinite(value) && value > 0; }

/// A cropped image may have its principal point outside, but not by more than its own size.
bool is_near(double centre, int side) { return centre >= -side && centre <= 2.0 * side; }

/// Coefficients of another lens model, or typed wrongly, fold the picture: then a pixel has no one ray.
bool can_be_undone(const CameraModel& camera) {
  const Eigen::Vector2d middle(camera.width / 2.0, camera.height / 2.0);
  for (const double x : {-0.5, 0.0, 0.5}) {
    for (const double y : {-0.5, 0.0, 0.5}) {
      const Eigen::Vector2d pixel = middle + Eigen::Vector2d(x, y).cwiseProduct(middle);
      const Eigen::Vector2d back = camera.project(camera.ray(pixel.x(), pixel.y()));
      if (!((back - pixel).norm() < 0.1)) return false;  // so that NaN fails too
    }
  }
  return true;
}

}  // namespace

Status check_camera(const CameraModel& camera) {
  if (!is_side(camera.width)) return bad("sensor.width", camera.width, "8 to 8192 pixels");
  if (!is_side(camera.height)) return bad("sensor.height", camera.height, "8 to 8192 pixels");
  if (!is_positive(camera.fx)) return bad("sensor.fx", camera.fx, "pixels, above 0");
  if (!is_positive(camera.fy)) return bad("sensor.fy", camera.fy, "pixels, above 0");
  if (!is_near(camera.cx, camera.width)) return bad("sensor.cx", camera.cx, "pixels, in or near the image");
  if (!is_near(camera.cy, camera.height)) return bad("sensor.cy", camera.cy, "pixels, in or near the image");
  if (!can_be_undone(camera))
    return fail(CaptureError::bad_value,
                "sensor.distortion (it folds the image; expected k1, k2, p1, p2, k3 of OpenCV)");
  return Done{};
}

Status check_depth_scale(double depth_scale_m) {
  if (depth_scale_m >= kMinDepthScale_m && depth_scale_m <= kMaxDepthScale_m) return Done{};
  return bad("sensor.depth_scale_m", depth_scale_m, "metres per unit, 0.001 for millimetres");
}

Status check_joints(std::span<const double> positions_rad, std::size_t joint_count, const std::string& key) {
  if (positions_rad.size() != joint_count)
    return fail(CaptureError::wrong_joint_count, key + " (" + std::to_string(positions_rad.size()) +
                                                     " values for " + std::to_string(joint_count) +
                                                     " joint names)");
  if (!std::ranges::all_of(positions_rad, [](double q) { return std::isfinite(q); }))
    return fail(CaptureError::wrong_joint_count, key + " (a value is not finite)");
  return Done{};
}

Status check_frame_count(std::size_t frames, const CameraModel& camera) {
  if (frames == 0) return fail(CaptureError::no_frames, "frames");
  const auto pixels = static_cast<std::uint64_t>(camera.width) * static_cast<std::uint64_t>(camera.height);
  if (frames <= kMaxPixels / pixels) return Done{};
  return bad("frames", frames, "a thousand million depth pixels at most; split the recording");
}

Status check_image_size(int width, int height, const CameraModel& camera, const std::string& file) {
  if (width == camera.width && height == camera.height) return Done{};
  return fail(CaptureError::wrong_image_size,
              file + " (" + std::to_string(width) + "x" + std::to_string(height) + ", expected " +
                  std::to_string(camera.width) + "x" + std::to_string(camera.height) + ")");
}

}  // namespace calibrd
