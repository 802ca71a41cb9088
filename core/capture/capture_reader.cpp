// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "core/capture/capture.hpp"
#include "core/capture/capture_error.hpp"
#include "core/capture/capture_rules.hpp"
#include "core/capture/file_bytes.hpp"
#include "core/capture/json_document.hpp"
#include "core/capture/png.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxDocumentBytes = 64U << 20U;

/// Stores the value of `expression` (a Result) in `target`, or returns its error from the calling function.
#define CALIBRD_TAKE(target, expression)  \
  {                                       \
    auto taken_ = (expression);           \
    if (!taken_) return taken_.error();   \
    (target) = std::move(taken_).value(); \
  }

/// Returns the error of `expression` (a Status), if it is one, from the calling function.
#define CALIBRD_CHECK(expression) \
  if (auto checked_ = (expression); !checked_) return checked_.error();

Result<boost::json::value> read_document(const fs::path& capture_dir) {
  std::error_code ignored;
  if (!fs::is_directory(capture_dir, ignored))
    return fail(CaptureError::no_such_folder, capture_dir.string());
  const fs::path path = capture_dir / "capture.json";
  std::string text;
  CALIBRD_TAKE(text, read_bytes(path, kMaxDocumentBytes));
  boost::json::value document;
  CALIBRD_TAKE(document, parse_json(text, path.string(), CaptureError::bad_json));
  if (!document.is_object()) return fail(CaptureError::bad_json, path.string() + " (not an object)");
  return document;
}

Status check_format(const JsonNode& root) {
  std::string format;
  CALIBRD_TAKE(format, root.text("format"));
  if (format != "capture/1") return fail(CaptureError::wrong_format, "format \"" + format + "\"");
  return Done{};
}

/// A package's own folder serves as well as the folder it lies in.
fs::path parent_of_package(const fs::path& place, const fs::path& relative) {
  std::error_code ignored;
  fs::path folder = fs::absolute(place, ignored).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();  // it ended in a slash
  return !relative.empty() && folder.filename() == *relative.begin() ? folder.parent_path() : fs::path();
}

Result<fs::path> find_urdf(const std::string& name, const fs::path& capture_dir,
                           std::span<const fs::path> models) {
  constexpr std::string_view kPackage = "package://";
  const fs::path relative = name.starts_with(kPackage) ? name.substr(kPackage.size()) : name;
  std::vector<fs::path> places{capture_dir};
  places.insert(places.end(), models.begin(), models.end());
  std::error_code ignored;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place / relative, ignored)) return place / relative;
    const fs::path parent = parent_of_package(place, relative);
    if (!parent.empty() && fs::is_regular_file(parent / relative, ignored)) return parent / relative;
  }
  return fail(CaptureError::urdf_not_found, "robot.urdf \"" + name + "\"");
}

Status read_robot(const JsonNode& robot, const fs::path& capture_dir, std::span<const fs::path> models,
                  Capture& capture) {
  std::string urdf;
  CALIBRD_TAKE(urdf, robot.text("urdf"));
  CALIBRD_TAKE(capture.urdf, find_urdf(urdf, capture_dir, models));
  CALIBRD_TAKE(capture.base_link, robot.text_or("base_link", ""));
  CALIBRD_TAKE(capture.joint_names, robot.texts("joint_names"));
  return Done{};
}

Result<int> whole_number(const JsonNode& node, std::string_view key) {
  double value = 0;
  CALIBRD_TAKE(value, node.number(key));
  if (value != std::floor(value) || std::abs(value) > 1e6)
    return fail(CaptureError::bad_value, node.name(key) + " (expected a whole number of pixels)");
  return static_cast<int>(value);
}

Result<std::array<double, 5>> read_distortion(const JsonNode& sensor) {
  std::array<double, 5> distortion{};
  if (!sensor.has("distortion")) return distortion;
  std::vector<double> list;
  CALIBRD_TAKE(list, sensor.numbers("distortion"));
  if (list.size() != distortion.size())
    return fail(CaptureError::bad_value, sensor.name("distortion") + " (" + std::to_string(list.size()) +
                                             " numbers; expected k1, k2, p1, p2, k3)");
  std::ranges::copy(list, distortion.begin());
  return distortion;
}

Result<CameraModel> read_camera(const JsonNode& sensor) {
  CameraModel camera;
  CALIBRD_TAKE(camera.width, whole_number(sensor, "width"));
  CALIBRD_TAKE(camera.height, whole_number(sensor, "height"));
  CALIBRD_TAKE(camera.fx, sensor.number("fx"));
  CALIBRD_TAKE(camera.fy, sensor.number("fy"));
  CALIBRD_TAKE(camera.cx, sensor.number("cx"));
  CALIBRD_TAKE(camera.cy, sensor.number("cy"));
  CALIBRD_TAKE(camera.distortion, read_distortion(sensor));
  CALIBRD_CHECK(check_camera(camera));
  return camera;
}

Result<PngImage> read_image(const JsonNode& frame, std::string_view key, const fs::path& capture_dir,
                            const CameraModel& camera) {
  std::string name;
  CALIBRD_TAKE(name, frame.text(key));
  auto path = path_inside(capture_dir, name);
  if (!path) return Error{path.error().code, frame.name(key) + " " + path.error().detail};
  return read_png(*path, &camera);
}

Result<View> read_view(const JsonNode& frame, const fs::path& capture_dir, const Capture& capture,
                       double depth_scale_m, CaptureImages images) {
  View view;
  PngImage depth;
  CALIBRD_TAKE(depth, read_image(frame, "depth", capture_dir, capture.camera));
  if (depth.bit_depth != 16 || depth.channels != 1)
    return fail(CaptureError::wrong_bit_depth, frame.name("depth") + " (" + std::to_string(depth.bit_depth) +
                                                   " bits, " + (depth.channels == 1 ? "grey)" : "colour)"));
  view.depth = {depth.width, depth.height, depth_scale_m, std::move(depth.pixels)};
  if (images == CaptureImages::read && frame.has("image")) {
    PngImage image;
    CALIBRD_TAKE(image, read_image(frame, "image", capture_dir, capture.camera));
    view.image = GreyImage{image.width, image.height, std::move(image.pixels)};
  }
  CALIBRD_TAKE(view.joint_positions_rad, frame.numbers("joint_positions_rad"));
  CALIBRD_CHECK(
      check_joints(view.joint_positions_rad, capture.joint_names.size(), frame.name("joint_positions_rad")));
  if (frame.has("stamp_s")) CALIBRD_TAKE(view.stamp_s, frame.number("stamp_s"));
  return view;
}

Status read_views(const JsonNode& root, const fs::path& capture_dir, double depth_scale_m,
                  CaptureImages images, Capture& capture) {
  const auto frames = root.objects("frames");
  if (!frames) return frames.error();
  CALIBRD_CHECK(check_frame_count(frames->size(), capture.camera));
  for (const JsonNode& frame : *frames) {
    auto view = read_view(frame, capture_dir, capture, depth_scale_m, images);
    if (!view) return view.error();
    capture.views.push_back(std::move(view).value());
  }
  return Done{};
}

}  // namespace

Result<Capture> read_capture(const fs::path& capture_dir, std::span<const fs::path> models,
                             CaptureImages images) {
  const auto document = read_document(capture_dir);
  if (!document) return document.error();
  const JsonNode root(document->get_object(), "");
  CALIBRD_CHECK(check_format(root));

  Capture capture;
  CALIBRD_TAKE(capture.note, root.text_or("note", ""));
  const auto robot = root.object("robot");
  if (!robot) return robot.error();
  CALIBRD_CHECK(read_robot(*robot, capture_dir, models, capture));

  const auto sensor = root.object("sensor");
  if (!sensor) return sensor.error();
  CALIBRD_TAKE(capture.sensor_id, sensor->text_or("id", ""));
  CALIBRD_TAKE(capture.camera, read_camera(*sensor));
  double depth_scale_m = 0;
  CALIBRD_TAKE(depth_scale_m, sensor->number("depth_scale_m"));
  CALIBRD_CHECK(check_depth_scale(depth_scale_m));
  CALIBRD_CHECK(read_views(root, capture_dir, depth_scale_m, images, capture));
  return capture;
}

#undef CALIBRD_TAKE
#undef CALIBRD_CHECK

}  // namespace calibrd
