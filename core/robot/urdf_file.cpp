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

namespace calibrd {
namespace {

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

}  // namespace

Result<std::shared_ptr<const urdf::ModelInterface>> read_urdf(const std::filesystem::path& file) {
  const auto text = read_text(file);
  if (!text) return Error{RobotModelError::urdf_not_found, file.string()};
  if (text->find_first_not_of(" \t\r\n") == std::string::npos) return invalid(file, "the file is empty");

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
