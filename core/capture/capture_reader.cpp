// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json.hpp>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/capture/capture.hpp"
#include "core/capture/capture_error.hpp"
#include "core/capture/png.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

/// A JSON object and the way to it, so that every error names the key at fault.
class Node {
 public:
  Node(const json::object& object, std::string path) : object_(object), path_(std::move(path)) {}

  bool has(std::string_view key) const { return object_.contains(key); }
  std::string name(std::string_view key) const { return path_ + "." + std::string(key); }

  Result<double> number(std::string_view key) const {
    const json::value* value = object_.if_contains(key);
    if (value == nullptr) return fail(CaptureError::missing_key, name(key));
    if (!value->is_number() || !std::isfinite(value->to_number<double>()))
      return fail(CaptureError::bad_value, name(key));
    return value->to_number<double>();
  }
  Result<std::string> text(std::string_view key) const {
    const json::value* value = object_.if_contains(key);
    if (value == nullptr) return fail(CaptureError::missing_key, name(key));
    if (!value->is_string()) return fail(CaptureError::bad_value, name(key));
    return std::string(value->get_string());
  }
  std::string text_or(std::string_view key, std::string fallback) const {
    const json::value* value = object_.if_contains(key);
    return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::move(fallback);
  }
  Result<const json::array*> array(std::string_view key) const {
    const json::value* value = object_.if_contains(key);
    if (value == nullptr) return fail(CaptureError::missing_key, name(key));
    if (!value->is_array()) return fail(CaptureError::bad_value, name(key));
    return &value->get_array();
  }
  Result<Node> object(std::string_view key) const {
    const json::value* value = object_.if_contains(key);
    if (value == nullptr) return fail(CaptureError::missing_key, name(key));
    if (!value->is_object()) return fail(CaptureError::bad_value, name(key));
    return Node(value->get_object(), name(key));
  }

 private:
  const json::object& object_;
  std::string path_;
};

Result<json::object> read_document(const fs::path& capture_dir) {
  std::error_code ignored;
  if (!fs::is_directory(capture_dir, ignored))
    return fail(CaptureError::no_such_folder, capture_dir.string());
  const fs::path path = capture_dir / "capture.json";
  std::ifstream file(path);
  if (!file) return fail(CaptureError::unreadable, path.string());
  std::ostringstream text;
  text << file.rdbuf();
  boost::system::error_code error;
  json::value document = json::parse(text.str(), error);
  if (error) return fail(CaptureError::bad_json, path.string() + " (" + error.message() + ")");
  if (!document.is_object()) return fail(CaptureError::bad_json, path.string() + " (not an object)");
  return std::move(document.get_object());
}

/// Stores the value of `expression` (a Result) in `target`, or returns its error from the calling function.
#define CALIBRD_TAKE(target, expression)  \
  {                                       \
    auto taken_ = (expression);           \
    if (!taken_) return taken_.error();   \
    (target) = std::move(taken_).value(); \
  }

Result<std::array<double, 5>> read_distortion(const Node& sensor) {
  std::array<double, 5> distortion{};
  if (!sensor.has("distortion")) return distortion;
  auto list = sensor.array("distortion");
  if (!list) return list.error();
  if ((*list)->size() != distortion.size())
    return fail(CaptureError::bad_value, sensor.name("distortion") + " (k1, k2, p1, p2, k3)");
  for (std::size_t i = 0; i < distortion.size(); ++i) {
    const json::value& value = (**list)[i];
    if (!value.is_number() || !std::isfinite(value.to_number<double>()))
      return fail(CaptureError::bad_value, sensor.name("distortion"));
    distortion[i] = value.to_number<double>();
  }
  return distortion;
}

Result<CameraModel> read_camera(const Node& sensor) {
  CameraModel camera;
  double width = 0, height = 0;
  CALIBRD_TAKE(width, sensor.number("width"));
  CALIBRD_TAKE(height, sensor.number("height"));
  CALIBRD_TAKE(camera.fx, sensor.number("fx"));
  CALIBRD_TAKE(camera.fy, sensor.number("fy"));
  CALIBRD_TAKE(camera.cx, sensor.number("cx"));
  CALIBRD_TAKE(camera.cy, sensor.number("cy"));
  CALIBRD_TAKE(camera.distortion, read_distortion(sensor));
  if (!(width >= 8 && width <= 8192 && height >= 8 && height <= 8192) || width != std::floor(width) ||
      height != std::floor(height))
    return fail(CaptureError::bad_value, sensor.name("width/height") + " (8 to 8192 pixels)");
  if (!(camera.fx > 0) || !(camera.fy > 0))
    return fail(CaptureError::bad_value, sensor.name("fx/fy") + " (must be above 0)");
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  return camera;
}

Status check_size(const PngImage& image, const CameraModel& camera, const fs::path& path) {
  if (image.width == camera.width && image.height == camera.height) return Done{};
  return fail(CaptureError::wrong_image_size,
              path.string() + " (" + std::to_string(image.width) + "x" + std::to_string(image.height) +
                  ", expected " + std::to_string(camera.width) + "x" + std::to_string(camera.height) + ")");
}

Result<std::vector<double>> read_joints(const Node& frame, std::size_t count) {
  auto list = frame.array("joint_positions_rad");
  if (!list) return list.error();
  std::vector<double> positions;
  for (const json::value& value : **list) {
    if (value.is_number()) positions.push_back(value.to_number<double>());
    if (!value.is_number() || !std::isfinite(positions.back()))
      return fail(CaptureError::wrong_joint_count, frame.name("joint_positions_rad"));
  }
  if (positions.size() != count)
    return fail(CaptureError::wrong_joint_count, frame.name("joint_positions_rad") + " (" +
                                                     std::to_string(positions.size()) + " values for " +
                                                     std::to_string(count) + " joint names)");
  return positions;
}

Result<View> read_view(const Node& frame, const fs::path& capture_dir, const Capture& capture,
                       double depth_scale_m) {
  View view;
  std::string name;
  CALIBRD_TAKE(name, frame.text("depth"));
  PngImage depth;
  CALIBRD_TAKE(depth, read_png(capture_dir / name));
  if (auto ok = check_size(depth, capture.camera, capture_dir / name); !ok) return ok.error();
  if (depth.bit_depth != 16 || depth.channels != 1)
    return fail(CaptureError::wrong_bit_depth, (capture_dir / name).string());
  view.depth = {depth.width, depth.height, depth_scale_m, std::move(depth.pixels)};
  if (frame.has("image")) {
    CALIBRD_TAKE(name, frame.text("image"));
    PngImage image;
    CALIBRD_TAKE(image, read_png(capture_dir / name));
    if (auto ok = check_size(image, capture.camera, capture_dir / name); !ok) return ok.error();
    view.image = GreyImage{image.width, image.height, std::move(image.pixels)};
  }
  CALIBRD_TAKE(view.joint_positions_rad, read_joints(frame, capture.joint_names.size()));
  if (frame.has("stamp_s")) CALIBRD_TAKE(view.stamp_s, frame.number("stamp_s"));
  return view;
}

Result<fs::path> find_urdf(const std::string& name, const fs::path& capture_dir,
                           std::span<const fs::path> models) {
  std::vector<fs::path> places{capture_dir};
  places.insert(places.end(), models.begin(), models.end());
  constexpr std::string_view kPackage = "package://";
  const std::string relative = name.starts_with(kPackage) ? name.substr(kPackage.size()) : name;
  std::error_code ignored;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place / relative, ignored)) return place / relative;
    // `--models` may name the package's own folder rather than the one it lies in.
    const fs::path own = place.parent_path() / relative;
    if (relative.starts_with(place.filename().string() + "/") && fs::is_regular_file(own, ignored))
      return own;
  }
  return fail(CaptureError::urdf_not_found, name);
}

Status read_robot(const Node& robot, const fs::path& capture_dir, std::span<const fs::path> models,
                  Capture& capture) {
  std::string urdf;
  CALIBRD_TAKE(urdf, robot.text("urdf"));
  CALIBRD_TAKE(capture.urdf, find_urdf(urdf, capture_dir, models));
  capture.base_link = robot.text_or("base_link", "");
  auto names = robot.array("joint_names");
  if (!names) return names.error();
  for (const json::value& value : **names) {
    if (!value.is_string()) return fail(CaptureError::bad_value, robot.name("joint_names"));
    capture.joint_names.emplace_back(value.get_string());
  }
  return Done{};
}

Status read_views(const Node& root, const fs::path& capture_dir, double depth_scale_m, Capture& capture) {
  auto frames = root.array("frames");
  if (!frames) return frames.error();
  if ((*frames)->empty()) return fail(CaptureError::no_frames, capture_dir.string());
  for (std::size_t i = 0; i < (*frames)->size(); ++i) {
    const std::string path = "frames[" + std::to_string(i) + "]";
    if (!(**frames)[i].is_object()) return fail(CaptureError::bad_value, path);
    auto view = read_view(Node((**frames)[i].get_object(), path), capture_dir, capture, depth_scale_m);
    if (!view) return view.error();
    capture.views.push_back(std::move(view).value());
  }
  return Done{};
}

}  // namespace

Result<Capture> read_capture(const fs::path& capture_dir, std::span<const fs::path> models) {
  json::object document;
  CALIBRD_TAKE(document, read_document(capture_dir));
  const Node root(document, "capture.json");
  std::string format;
  CALIBRD_TAKE(format, root.text("format"));
  if (format != "capture/1") return fail(CaptureError::wrong_format, "\"" + format + "\"");

  Capture capture;
  capture.note = root.text_or("note", "");
  auto robot = root.object("robot");
  if (!robot) return robot.error();
  if (auto ok = read_robot(*robot, capture_dir, models, capture); !ok) return ok.error();
  auto sensor = root.object("sensor");
  if (!sensor) return sensor.error();
  capture.sensor_id = sensor->text_or("id", "");
  CALIBRD_TAKE(capture.camera, read_camera(*sensor));
  double depth_scale_m = 0;
  CALIBRD_TAKE(depth_scale_m, sensor->number("depth_scale_m"));
  if (!(depth_scale_m > 0 && depth_scale_m <= 1))
    return fail(CaptureError::bad_value, sensor->name("depth_scale_m"));
  if (auto ok = read_views(root, capture_dir, depth_scale_m, capture); !ok) return ok.error();
  return capture;
}

#undef CALIBRD_TAKE

}  // namespace calibrd
