// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/calibrate_command.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <iostream>

#include "api/json/calibration_result_json.hpp"
#include "api/json/next_posture_json.hpp"
#include "core/calibration/calibrate.hpp"
#include "core/calibration/model_views.hpp"
#include "core/capture/pose_json.hpp"
#include "core/paper/paper_error.hpp"
#include "core/paper/region.hpp"
#include "core/planning/next_posture.hpp"
#include "core/planning/table_height.hpp"

namespace calibrd {
namespace {

constexpr int kAccepted = 0, kUnusable = 2, kNotAccepted = 3;

struct Loaded {
  RobotModel robot;
  CameraModel camera;
  std::vector<View> views;
  CalibrationSettings settings;
};

/// What --roi and --sampling say; they belong to the paper's method.
Result<PaperSettings> paper_settings(const CalibrateOptions& options) {
  PaperSettings paper;
  const bool asked_for = !options.roi.empty() || !options.sampling.empty();
  if (asked_for && options.method != "paper") return fail(PaperError::other_method, "--roi, --sampling");
  if (options.sampling == "three-sensors") paper.sampling = PaperSampling::three_sensors;
  if (options.roi.empty()) return paper;
  const auto region = parse_region(options.roi);
  if (!region) return region.error();
  paper.region_sensor = *region;
  return paper;
}

/// "x,y,z" or "NAME=x,y,z"; without a name it is called by its place in the row.
std::optional<WorkspacePoint> parse_point(const std::string& text, std::size_t place) {
  const auto equals = text.find('=');
  WorkspacePoint point;
  point.name = equals == std::string::npos ? "point_" + std::to_string(place + 1) : text.substr(0, equals);
  const std::string numbers = equals == std::string::npos ? text : text.substr(equals + 1);
  char beyond = 0;
  Eigen::Vector3d& p = point.p_base;
  if (std::sscanf(numbers.c_str(), "%lf,%lf,%lf%c", &p.x(), &p.y(), &p.z(), &beyond) != 3 || !p.allFinite() ||
      point.name.empty())
    return std::nullopt;
  return point;
}

std::string check_point(const std::string& text) {
  return parse_point(text, 0) ? "" : "\"" + text + "\" is not x,y,z or NAME=x,y,z (m, base frame)";
}

std::string check_table_height(const std::string& text) {
  return parse_table_height(text) ? "" : not_a_table_height(text);
}

Result<Loaded> load(const CalibrateOptions& options) {
  CalibrationSettings settings;
  settings.method = options.method == "paper" ? Method::paper : Method::full;
  auto paper = paper_settings(options);
  if (!paper) return paper.error();
  settings.paper = *paper;
  settings.depth_only = options.depth_only;
  if (!options.guess.empty()) {
    auto guess = read_pose(options.guess);
    if (!guess) return guess.error();
    settings.guess_T_base_sensor = *guess;
  }
  for (const std::string& text : options.workspace)
    if (const auto point = parse_point(text, settings.workspace.size())) settings.workspace.push_back(*point);
  const auto images = options.depth_only ? CaptureImages::ignore : CaptureImages::read;
  auto capture = read_capture(options.capture_dir, options.models, images);
  if (!capture) return capture.error();
  RobotModelOptions model_options{{options.capture_dir}, capture->base_link};
  model_options.search_paths.insert(model_options.search_paths.end(), options.models.begin(),
                                    options.models.end());
  auto robot = RobotModel::load(capture->urdf, model_options);
  if (!robot) return robot.error();
  const CameraModel camera = capture->camera;
  auto views = views_in_model_order(*robot, std::move(*capture));
  if (!views) return views.error();
  return Loaded{std::move(*robot), camera, std::move(*views), std::move(settings)};
}

/// Nothing without a pose; nor for the paper's method, which says nothing about its uncertainty.
std::optional<PostureSuggestion> next_posture(const Loaded& input, const CalibrationResult& result,
                                              double table_height_m) {
  if (!result.T_base_sensor || input.settings.method == Method::paper) return std::nullopt;
  std::vector<std::vector<double>> seen;
  for (const View& view : input.views) seen.push_back(view.joint_positions_rad);
  PlanningSettings settings;
  settings.min_height_m = table_height_m;
  return suggest_posture(VirtualCell(input.robot), input.camera, *result.T_base_sensor, result.covariance,
                         seen, settings);
}

}  // namespace

void add_calibrate_options(CLI::App& command, CalibrateOptions& options) {
  command.add_option("CAPTURE_DIR", options.capture_dir, "Folder of a capture/1 recording")->required();
  command
      .add_option("--models", options.models, "Folder to look robot models and meshes up in; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--guess", options.guess,
                     "Rough pose: a JSON file with T_base_sensor, or x,y,z,qx,qy,qz,qw");
  command
      .add_option(
          "--workspace", options.workspace,
          "Point to tell the predicted error of: x,y,z or NAME=x,y,z (m, base frame); may be repeated")
      ->allow_extra_args(false)
      ->check(check_point);
  command.add_option("--method", options.method, "full, or paper for the published method")
      ->check(CLI::IsMember({"full", "paper"}));
  command.add_option("--roi", options.roi,
                     "Region of interest of the method paper, sensor frame, m: x0,y0,z0,x1,y1,z1; default: "
                     "around the robot at the guess");
  command
      .add_option("--sampling", options.sampling,
                  "Virtual measurement of the method paper: uniform (default), or three-sensors")
      ->check(CLI::IsMember({"uniform", "three-sensors"}));
  command.add_flag("--depth-only", options.depth_only, "Ignore the images of the recording");
  auto* suggest =
      command.add_flag("--suggest", options.suggest, "Also print the posture that would help most next");
  command
      .add_option("--table-height", options.table_height_m,
                  "What --suggest suggests stays above this height in the base frame, m; default: 0")
      ->needs(suggest)
      ->check(check_table_height);
  command.add_flag("--json", options.json, "Print JSON (always the case)");
}

int run_calibrate(const CalibrateOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const auto input = load(options);
  if (!input) {
    std::cerr << "calibrd: " << input.error().message() << '\n';
    return kUnusable;
  }
  const std::chrono::duration<double, std::milli> load_time = std::chrono::steady_clock::now() - begin;
  const CalibrationResult result = calibrate(input->robot, input->camera, input->views, input->settings);
  std::cout << (options.suggest
                    ? api::calibration_and_next_posture_json(
                          result, load_time.count(), next_posture(*input, result, options.table_height_m))
                    : api::calibration_result_json(result, load_time.count()))
            << '\n';
  return result.verdict == Verdict::accepted ? kAccepted : kNotAccepted;
}

}  // namespace calibrd
