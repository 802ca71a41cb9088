// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/stream_request.hpp"

#include <charconv>
#include <optional>
#include <string_view>

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {
namespace {

constexpr int kMaxSide = 4096;  // px
constexpr int kMaxFps = 1000;

template <class T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T>
bool set(T& field, std::optional<T> value) {
  if (value) field = *value;
  return value.has_value();
}

std::optional<bool> flag(std::string_view text) {
  if (text == "0" || text == "1") return text == "1";
  return std::nullopt;
}

std::optional<ImageKind> image_kind(std::string_view text) {
  if (text == "none") return ImageKind::none;
  if (text == "infrared") return ImageKind::infrared;
  if (text == "color") return ImageKind::color;
  return std::nullopt;
}

const char* name(ImageKind kind) {
  return kind == ImageKind::none ? "none" : kind == ImageKind::infrared ? "infrared" : "color";
}

std::string shortest(double value) {
  char text[32];
  const auto result = std::to_chars(text, text + sizeof(text), value);
  return {text, result.ptr};
}

bool set_key(StreamRequest& request, std::string_view key, std::string_view value) {
  if (key == "device") return request.device = value, true;
  if (key == "recording") return request.recording = value, true;
  if (key == "speed") return set(request.speed, number<double>(value));
  if (key == "loop") return set(request.loop, flag(value));
  if (key == "width") return set(request.width, number<int>(value));
  if (key == "height") return set(request.height, number<int>(value));
  if (key == "fps") return set(request.fps, number<int>(value));
  if (key == "depth-unit-um") return set(request.depth_unit_um, number<int>(value));
  if (key == "image") return set(request.image, image_kind(value));
  if (key == "mirror") return set(request.mirror, flag(value));
  return false;
}

Error bad(const char* key, const std::string& value) {
  return sensor_error(SensorError::invalid_settings, std::string(key) + " = " + value);
}

}  // namespace

Status check(const StreamRequest& r) {
  if (r.width < 1 || r.width > kMaxSide) return bad("width", std::to_string(r.width));
  if (r.height < 1 || r.height > kMaxSide) return bad("height", std::to_string(r.height));
  if (r.fps < 0 || r.fps > kMaxFps) return bad("fps", std::to_string(r.fps));
  if (r.depth_unit_um != 1000 && r.depth_unit_um != 100)
    return bad("depth_unit_um", std::to_string(r.depth_unit_um));
  if (!(r.speed > 0 && r.speed <= 100)) return bad("speed", shortest(r.speed));
  if (!r.device.empty() && !r.recording.empty())
    return bad("recording", r.recording + " beside device = " + r.device);
  return Done{};
}

std::vector<std::string> to_arguments(const StreamRequest& r) {
  return {"--device=" + r.device,
          "--recording=" + r.recording,
          "--speed=" + shortest(r.speed),
          std::string("--loop=") + (r.loop ? "1" : "0"),
          "--width=" + std::to_string(r.width),
          "--height=" + std::to_string(r.height),
          "--fps=" + std::to_string(r.fps),
          "--depth-unit-um=" + std::to_string(r.depth_unit_um),
          std::string("--image=") + name(r.image),
          std::string("--mirror=") + (r.mirror ? "1" : "0")};
}

Result<StreamRequest> request_from_arguments(std::span<const std::string> arguments) {
  StreamRequest request;
  for (const std::string& argument : arguments) {
    const auto equals = argument.find('=');
    const bool is_pair = argument.starts_with("--") && equals != std::string::npos;
    const std::string_view text = argument;
    if (!is_pair || !set_key(request, text.substr(2, equals - 2), text.substr(equals + 1)))
      return sensor_error(SensorError::invalid_settings, "argument " + argument);
  }
  if (auto checked = check(request); !checked) return checked.error();
  return request;
}

}  // namespace calibrd
