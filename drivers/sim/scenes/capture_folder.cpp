// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/scenes/capture_folder.hpp"

#include <spng.h>

#include <cstdio>
#include <fstream>
#include <memory>

#include "drivers/sim/model/fields.hpp"
#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {
namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr const char* kLevels[] = {"clean", "cell", "field"};

std::string numbered(const char* stem, std::size_t index) {
  char name[32];
  std::snprintf(name, sizeof(name), "%s_%03zu.png", stem, index);
  return name;
}

Status write_png(const fs::path& path, const CameraParameters& camera,
                 const std::vector<std::uint16_t>& pixels) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> png(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), &std::fclose);
  if (!file || !png) return sim_error(SimError::capture_unwritable, path.string());
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(camera.width);
  header.height = static_cast<std::uint32_t>(camera.height);
  header.bit_depth = 16;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  spng_set_png_file(png.get(), file.get());
  spng_set_ihdr(png.get(), &header);
  spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, 1);  // noise does not shrink, whatever the effort
  const int failed = spng_encode_image(png.get(), pixels.data(), pixels.size() * sizeof(std::uint16_t),
                                       SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  if (failed != 0 || std::fflush(file.get()) != 0)
    return sim_error(SimError::capture_unwritable, path.string());
  return Done{};
}

json::array numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

json::object capture_json(const SimulatedCapture& capture, const std::string& urdf) {
  const CameraParameters& c = capture.camera;
  json::array names(capture.joint_names.begin(), capture.joint_names.end()), frames;
  for (std::size_t i = 0; i < capture.views.size(); ++i) {
    const auto& joints = capture.views[i].joint_positions_rad;
    frames.push_back({{"depth", numbered("depth", i)},
                      {"image", numbered("image", i)},
                      {"joint_positions_rad", json::array(joints.begin(), joints.end())}});
  }
  const json::object sensor{{"id", "kinect2"},
                            {"width", c.width},
                            {"height", c.height},
                            {"fx", c.fx},
                            {"fy", c.fy},
                            {"cx", c.cx},
                            {"cy", c.cy},
                            {"distortion", json::array(c.distortion.begin(), c.distortion.end())},
                            {"depth_scale_m", 0.001}};
  return {{"format", "capture/1"},
          {"note", std::string("simulated, level ") + kLevels[static_cast<int>(capture.level)] + ", seed " +
                       std::to_string(capture.seed)},
          {"robot", {{"urdf", urdf}, {"base_link", capture.base_link}, {"joint_names", names}}},
          {"sensor", sensor},
          {"frames", frames}};
}

json::object truth_json(const SimulatedCapture& capture) {
  json::array points, pixels;
  for (const auto& point : capture.check_points)
    points.push_back({{"p_sensor", numbers(point.p_sensor)}, {"p_base", numbers(point.p_base)}});
  for (const auto& view : capture.views) pixels.push_back(view.robot_pixels);
  const DepthErrors& e = capture.depth_errors;
  return {{"T_base_sensor", to_json(capture.T_base_sensor)},
          {"depth_offset_m", e.offset_m},
          {"depth_scale", e.scale},
          {"wiggle_m", e.wiggle_m},
          {"wiggle_period_m", e.wiggle_period_m},
          {"wiggle_phase_rad", e.wiggle_phase_rad},
          {"joint_zero_rad", json::array(capture.joint_zero_rad.begin(), capture.joint_zero_rad.end())},
          {"robot_pixels", pixels},
          {"check_points", points}};
}

Status write_text(const fs::path& path, const json::object& value) {
  std::ofstream file(path);
  file << json::serialize(value) << '\n';
  if (!file.flush()) return sim_error(SimError::capture_unwritable, path.string());
  return Done{};
}

}  // namespace

Status write_capture_folder(const fs::path& folder, const SimulatedCapture& capture,
                            const std::string& urdf) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed || !fs::is_empty(folder, failed) || failed)
    return sim_error(SimError::capture_unwritable, folder.string());
  for (std::size_t i = 0; i < capture.views.size(); ++i) {
    const SimulatedView& view = capture.views[i];
    if (auto written = write_png(folder / numbered("depth", i), capture.camera, view.depth_mm); !written)
      return written;
    if (auto written = write_png(folder / numbered("image", i), capture.camera, view.infrared); !written)
      return written;
  }
  if (auto written = write_text(folder / "truth.json", truth_json(capture)); !written) return written;
  return write_text(folder / "capture.json", capture_json(capture, urdf));
}

}  // namespace calibrd::sim
