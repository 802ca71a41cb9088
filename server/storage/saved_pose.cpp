// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/saved_pose.hpp"

#include <array>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "server/storage/durable_file.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr const char* kFormat = "calibrd saved pose/1";

/// FNV-1a, 64 bits: against damage, not against anybody.
std::string checksum(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  std::array<char, 24> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash));
  return digits.data();
}

/// Ids are the user's words: what could be a path, or mean something to one, is written in hexadecimal.
std::string file_name(const std::string& sensor_id) {
  std::string name;
  for (const char c : sensor_id) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    std::array<char, 4> code{};
    std::snprintf(code.data(), code.size(), "%%%02x", static_cast<unsigned char>(c));
    name += is_plain ? std::string(1, c) : code.data();
  }
  return name + ".json";
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

SavedPose pose_of(const json::object& object) {
  const auto text = [&](const char* key) { return std::string(object.at(key).as_string()); };
  const auto number = [&](const char* key) { return object.at(key).to_number<std::int64_t>(); };
  SavedPose pose;
  pose.sensor_id = text("sensor_id");
  pose.calibration_id = text("calibration_id");
  pose.created_ms = number("created_ms");
  pose.finished_ms = number("finished_ms");
  pose.method = text("method");
  pose.postures = number("postures");
  pose.postures_seen = number("postures_seen");
  pose.result = text("result");
  pose.basis = text("basis");
  pose.drifted = object.at("drifted").as_bool();
  pose.background = text("background");
  return pose;
}

}  // namespace

std::string saved_pose_text(const SavedPose& pose) {
  const json::object object{{"format", kFormat},
                            {"sensor_id", pose.sensor_id},
                            {"calibration_id", pose.calibration_id},
                            {"created_ms", pose.created_ms},
                            {"finished_ms", pose.finished_ms},
                            {"method", pose.method},
                            {"postures", pose.postures},
                            {"postures_seen", pose.postures_seen},
                            {"result", pose.result},
                            {"basis", pose.basis},
                            {"drifted", pose.drifted},
                            {"background", pose.background}};
  const auto line = json::serialize(object);
  return line + "\n" + checksum(line) + "\n";
}

Result<SavedPose> parse_saved_pose(const std::string& text) {
  const auto end = text.find('\n');
  if (end == std::string::npos) return Error{StorageError::damaged, "saved pose"};
  const auto line = text.substr(0, end);
  if (text.substr(end + 1) != checksum(line) + "\n") return Error{StorageError::damaged, "saved pose"};
  try {
    const auto value = json::parse(line);
    if (value.at("format") != kFormat) return Error{StorageError::newer_schema, "saved pose"};
    return pose_of(value.as_object());
  } catch (const std::exception& failure) {
    return Error{StorageError::damaged, std::string("saved pose: ") + failure.what()};
  }
}

fs::path saved_pose_folder(const fs::path& database) {
  auto folder = database;
  folder += ".last";
  return folder;
}

Status save_pose(const fs::path& folder, const SavedPose& pose) {
  const auto file = folder / file_name(pose.sensor_id);
  const auto text = saved_pose_text(pose);
  if (content_of(file) == text) return Done{};  // also where there is no room to write it anew
  if (auto made = make_folders_durably(folder); !made) return made;
  return write_durably(file, text);
}

void forget_pose(const fs::path& folder, const std::string& sensor_id) {
  std::error_code ignored;
  if (fs::remove(folder / file_name(sensor_id), ignored)) (void)sync_folder(folder).has_value();
}

std::vector<SavedPose> read_saved_poses(const fs::path& folder) {
  std::vector<SavedPose> poses;
  for (const auto& name : names_in(folder)) {
    if (!name.ends_with(".json")) continue;
    if (auto pose = parse_saved_pose(content_of(folder / name))) poses.push_back(*std::move(pose));
  }
  return poses;
}

}  // namespace calibrd
