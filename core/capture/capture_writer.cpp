// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "core/capture/capture.hpp"
#include "core/capture/capture_error.hpp"
#include "core/capture/capture_rules.hpp"
#include "core/capture/png.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

std::string numbered(const char* stem, std::size_t index) {
  char name[32];
  std::snprintf(name, sizeof name, "%s_%03zu.png", stem, index);
  return name;
}

Status check_view(const View& view, const Capture& capture, const std::string& name) {
  const CameraModel& camera = capture.camera;
  if (auto ok = check_image_size(view.depth.width, view.depth.height, camera, name + ".depth"); !ok)
    return ok;
  if (view.image)
    if (auto ok = check_image_size(view.image->width, view.image->height, camera, name + ".image"); !ok)
      return ok;
  // capture.json holds one scale for all frames.
  if (view.depth.scale_m != capture.views.front().depth.scale_m)
    return fail(CaptureError::bad_value, name + ".depth (its scale is not that of the first frame)");
  if (!std::isfinite(view.stamp_s)) return fail(CaptureError::bad_value, name + ".stamp_s (not finite)");
  return check_joints(view.joint_positions_rad, capture.joint_names.size(), name + ".joint_positions_rad");
}

/// What a reader would refuse is not written.
Status check(const Capture& capture) {
  if (auto ok = check_camera(capture.camera); !ok) return ok;
  if (auto ok = check_frame_count(capture.views.size(), capture.camera); !ok) return ok;
  if (auto ok = check_depth_scale(capture.views.front().depth.scale_m); !ok) return ok;
  for (std::size_t i = 0; i < capture.views.size(); ++i)
    if (auto ok = check_view(capture.views[i], capture, "frames[" + std::to_string(i) + "]"); !ok) return ok;
  return Done{};
}

json::object describe_sensor(const Capture& capture) {
  const CameraModel& c = capture.camera;
  return {{"id", capture.sensor_id},
          {"width", c.width},
          {"height", c.height},
          {"fx", c.fx},
          {"fy", c.fy},
          {"cx", c.cx},
          {"cy", c.cy},
          {"distortion", json::value_from(c.distortion)},
          {"depth_scale_m", capture.views.front().depth.scale_m}};
}

json::object describe_robot(const Capture& capture, const std::string& urdf_reference) {
  json::object robot{{"urdf", urdf_reference}, {"joint_names", json::value_from(capture.joint_names)}};
  if (!capture.base_link.empty()) robot["base_link"] = capture.base_link;
  return robot;
}

Result<json::object> write_view(const fs::path& folder, const View& view, std::size_t index) {
  const std::string depth = numbered("depth", index), image = numbered("image", index);
  if (auto ok = write_png16(folder / depth, view.depth.width, view.depth.height, view.depth.raw); !ok)
    return ok.error();
  json::object frame{{"depth", depth},
                     {"joint_positions_rad", json::value_from(view.joint_positions_rad)},
                     {"stamp_s", view.stamp_s}};
  if (view.image) {
    if (auto ok = write_png16(folder / image, view.image->width, view.image->height, view.image->pixels); !ok)
      return ok.error();
    frame["image"] = image;
  }
  return frame;
}

Status write_all(const fs::path& folder, const Capture& capture, const std::string& urdf_reference) {
  json::array frames;
  for (std::size_t i = 0; i < capture.views.size(); ++i) {
    auto frame = write_view(folder, capture.views[i], i);
    if (!frame) return frame.error();
    frames.emplace_back(std::move(frame).value());
  }
  const json::object document{{"format", "capture/1"},
                              {"note", capture.note},
                              {"robot", describe_robot(capture, urdf_reference)},
                              {"sensor", describe_sensor(capture)},
                              {"frames", std::move(frames)}};
  std::ofstream file(folder / "capture.json");
  file << json::serialize(document) << '\n';
  file.close();
  if (!file) return fail(CaptureError::unwritable, (folder / "capture.json").string());
  return Done{};
}

/// The folder's path without `.`, `..` and a slash at its end.
fs::path cleaned(const fs::path& folder) {
  std::error_code ignored;
  const fs::path normal = fs::absolute(folder, ignored).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

/// A new folder beside `target`: what stands there already belongs to somebody else.
Result<fs::path> make_partial_folder(const fs::path& target) {
  constexpr int kTries = 1000;
  std::error_code error;
  fs::create_directories(target.parent_path(), error);
  for (int i = 0; i < kTries && !error; ++i) {
    fs::path partial = target;
    partial += ".partial" + std::to_string(i);
    if (fs::create_directory(partial, error)) return partial;
  }
  return fail(CaptureError::unwritable, target.string() + " (" + error.message() + ")");
}

Status check_target(const fs::path& target) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (!fs::exists(status)) return Done{};
  if (!fs::is_directory(status)) return fail(CaptureError::unwritable, target.string() + " (not a folder)");
  if (!fs::is_empty(target, error)) return fail(CaptureError::folder_not_empty, target.string());
  return Done{};
}

}  // namespace

Status write_capture(const fs::path& capture_dir, const Capture& capture, const std::string& urdf_reference) {
  if (auto ok = check(capture); !ok) return ok;
  const fs::path target = cleaned(capture_dir);
  if (auto ok = check_target(target); !ok) return ok;
  // Written beside and renamed, so that a half-written recording never carries the name asked for.
  const auto partial = make_partial_folder(target);
  if (!partial) return partial.error();
  Status done = write_all(*partial, capture, urdf_reference);
  std::error_code error;
  if (done) {
    fs::rename(*partial, target, error);  // takes the place of an empty folder, never of a full one
    if (error) done = fail(CaptureError::unwritable, target.string() + " (" + error.message() + ")");
  }
  if (!done) fs::remove_all(*partial, error);
  return done;
}

}  // namespace calibrd
