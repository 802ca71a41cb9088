// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <boost/json.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "bench.hpp"
#include "core/calibration/model_views.hpp"
#include "core/capture/pose_json.hpp"

namespace calibrd::bench {
namespace {

using Point = Eigen::Vector3d;

/// Where the sensor sees the last link and where the reported joints put it; empty without a truth.json.
std::vector<std::pair<Point, Point>> read_check_points(const std::filesystem::path& truth) {
  std::ifstream file(truth);
  std::ostringstream text;
  text << file.rdbuf();
  boost::system::error_code error;
  const boost::json::value document = boost::json::parse(text.str(), error);
  std::vector<std::pair<Point, Point>> points;
  if (error || !document.is_object() || !document.get_object().contains("check_points")) return points;
  const auto point = [](const boost::json::value& v) {
    return Point(v.at(0).to_number<double>(), v.at(1).to_number<double>(), v.at(2).to_number<double>());
  };
  for (const boost::json::value& entry : document.at("check_points").as_array())
    points.emplace_back(point(entry.at("p_sensor")), point(entry.at("p_base")));
  return points;
}

[[noreturn]] void end(const Error& error) { std::exit(stop(error.message())); }

Eigen::Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

}  // namespace

Input load(const std::filesystem::path& capture_dir, const Paths& models) {
  auto capture = read_capture(capture_dir, models);
  if (!capture) end(capture.error());
  RobotModelOptions options{models, capture->base_link};
  options.search_paths.insert(options.search_paths.begin(), capture_dir);
  auto robot = RobotModel::load(capture->urdf, options);
  if (!robot) end(robot.error());
  const CameraModel camera = capture->camera;
  auto views = views_in_model_order(*robot, std::move(*capture));
  if (!views) end(views.error());
  Input input{std::move(*robot), camera, std::move(*views), read_check_points(capture_dir / "truth.json"),
              std::nullopt};
  if (auto truth = read_pose((capture_dir / "truth.json").string())) input.truth_T_base_sensor = *truth;
  return input;
}

int stop(const std::string& message) {
  std::fprintf(stderr, "calibrd-bench: %s\n", message.c_str());
  return 2;
}

Pose off_by(const Pose& T_base_sensor, double offset_m, double angle_rad, std::mt19937_64& random) {
  const Eigen::Vector3d ahead(0, 0, 1.3);
  return turned_about(T_base_sensor, ahead, angle_rad * random_direction(random),
                      offset_m * random_direction(random));
}

const char* name_of(Verdict verdict) {
  return verdict == Verdict::accepted ? "accepted" : verdict == Verdict::uncertain ? "uncertain" : "rejected";
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[values.size() / 2];
}

std::string shown(double value, int decimals) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

}  // namespace calibrd::bench
