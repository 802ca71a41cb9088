// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/urdf_file.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>

#include "core/robot/robot_model_error.hpp"
#include "core/robot/xml_tags.hpp"

namespace calibrd {
namespace {

constexpr std::uintmax_t kMaxBytes = 16U << 20U;
constexpr std::size_t kMaxDepth = 64;  // <robot><link><visual><geometry><mesh> is 5
constexpr std::size_t kMaxLinks =
    1000;  // urdfdom frees a chain of links link by link, each from within the last

/// urdfdom reports through console_bridge, which has one handler per process: hold it only under this lock.
std::mutex console_mutex;

class ConsoleCapture final : public console_bridge::OutputHandler {
 public:
  ConsoleCapture() : previous_(console_bridge::getOutputHandler()) { console_bridge::useOutputHandler(this); }
  ~ConsoleCapture() override { console_bridge::useOutputHandler(previous_); }
  ConsoleCapture(const ConsoleCapture&) = delete;
  ConsoleCapture& operator=(const ConsoleCapture&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) said_ += (said_.empty() ? "" : "; ") + text;
  }
  const std::string& said() const { return said_; }

 private:
  console_bridge::OutputHandler* previous_;
  std::string said_;
};

std::optional<std::string> read_text(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

Error invalid(const std::filesystem::path& file, const std::string& reason) {
  return {RobotModelError::urdf_invalid, file.string() + " (" + reason + ")"};
}

/// What would make urdfdom run out of stack, or of time.
std::optional<std::string> too_much(std::string_view text) {
  if (xml_depth(text) > kMaxDepth) return "elements more than " + std::to_string(kMaxDepth) + " deep";
  std::size_t links = 0;
  for (auto at = text.find("<link"); at != std::string_view::npos; at = text.find("<link", at + 1)) ++links;
  if (links > kMaxLinks) return "more than " + std::to_string(kMaxLinks) + " links";
  return std::nullopt;
}

}  // namespace

Result<std::shared_ptr<const urdf::ModelInterface>> read_urdf(const std::filesystem::path& file) {
  std::error_code ignored;
  if (const auto bytes = std::filesystem::file_size(file, ignored); !ignored && bytes > kMaxBytes)
    return invalid(file, std::to_string(bytes) + " bytes, at most " + std::to_string(kMaxBytes));
  const auto text = read_text(file);
  if (!text) return Error{RobotModelError::urdf_not_found, file.string()};
  if (text->find_first_not_of(" \t\r\n") == std::string::npos) return invalid(file, "the file is empty");
  if (const auto excess = too_much(*text)) return invalid(file, *excess);

  const std::scoped_lock lock(console_mutex);
  ConsoleCapture console;
  try {
    if (std::shared_ptr<const urdf::ModelInterface> model = urdf::parseURDF(*text)) return model;
  } catch (const std::exception& failed) {  // urdfdom throws on some malformed values
    return invalid(file, failed.what());
  }
  return invalid(file, console.said().empty() ? "urdfdom gives no reason" : console.said());
}

}  // namespace calibrd
