// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json.hpp>
#include <cstdio>
#include <fstream>

#include "core/capture/capture.hpp"
#include "core/capture/capture_error.hpp"
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
          {"depth_scale_m", capture.views.empty() ? 0.001 : capture.views.front().depth.scale_m}};
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

}  // namespace

Status write_capture(const fs::path& capture_dir, const Capture& capture, const std::string& urdf_reference) {
  std::error_code error;
  if (fs::exists(capture_dir, error) && !fs::is_empty(capture_dir, error))
    return fail(CaptureError::folder_not_empty, capture_dir.string());
  // Written beside and renamed, so that a half-written recording never carries the name asked for.
  fs::path partial = capture_dir.lexically_normal();
  if (!partial.has_filename()) partial = partial.parent_path();
  const fs::path target = partial;
  partial += ".partial";
  fs::remove_all(partial, error);
  if (!fs::create_directories(partial, error)) return fail(CaptureError::unwritable, partial.string());
  if (auto ok = write_all(partial, capture, urdf_reference); !ok) {
    fs::remove_all(partial, error);
    return ok;
  }
  fs::remove(target, error);  // an empty folder may stand there
  fs::rename(partial, target, error);
  if (error) return fail(CaptureError::unwritable, target.string() + " (" + error.message() + ")");
  return Done{};
}

}  // namespace calibrd
