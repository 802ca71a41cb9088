// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/clouds/frame_file.hpp"

#include <boost/json/object.hpp>
#include <boost/json/value_from.hpp>

#include "api/json/camera_json.hpp"
#include "api/json/json_text.hpp"
#include "api/json/pose_json.hpp"
#include "api/problem/api_error.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

void append_length(std::string& bytes, std::size_t length) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((length >> shift) & 0xffU);
}

void append_plane(std::string& bytes, const std::vector<std::uint16_t>& plane) {
  for (const std::uint16_t value : plane) {
    bytes += static_cast<char>(value & 0xffU);
    bytes += static_cast<char>(value >> 8U);
  }
}

json::object header_json(const SensorFrame& frame) {
  const auto nanoseconds = [](Clock::time_point at) {
    return at.time_since_epoch() / std::chrono::nanoseconds(1);
  };
  return {{"camera", camera_json(frame.camera)},
          {"depth_scale_m", frame.depth_scale_m},
          {"frame_stamp_ns", nanoseconds(frame.exposed)},
          {"age_s", std::chrono::duration<double>(Clock::now() - frame.stamp).count()},
          {"joint_positions_rad", json::value_from(frame.joint_positions_rad)},
          {"T_base_sensor", frame.T_base_sensor ? json::value(matrix_json(*frame.T_base_sensor)) : nullptr},
          {"pose_valid", frame.pose_valid},
          {"links", json::value_from(frame.links)}};
}

std::string part(const json::object& header, const std::string& pixels) {
  const auto text = json_line(header);
  std::string bytes;
  bytes.reserve(text.size() + pixels.size() + 8);
  append_length(bytes, text.size());
  bytes += text;
  append_length(bytes, pixels.size());
  return bytes += pixels;
}

}  // namespace

std::string frame_part(const SensorFrame& frame) {
  std::string pixels;
  pixels.reserve(frame.depth.size() * 6);
  append_plane(pixels, frame.depth);
  append_plane(pixels, frame.predicted);
  for (const std::uint8_t link : frame.link) pixels += static_cast<char>(link);
  for (const PixelClass seen : frame.pixel_class) pixels += static_cast<char>(seen);
  return part(header_json(frame), pixels);
}

std::string frame_part(const Error& error) {
  const auto& entry = problem_entry(static_cast<ApiError>(error.code.value()));
  return part({{"code", entry.code}, {"title", entry.title}, {"detail", error.detail}}, {});
}

}  // namespace calibrd::api
