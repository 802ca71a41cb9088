// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/logging/logging.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "core/base/utc_text.hpp"

namespace calibrd {
namespace {

void append(spdlog::memory_buf_t& line, std::string_view text) {
  line.append(text.data(), text.data() + text.size());
}

/// Escapes what JSON wants escaped. Messages are UTF-8: foreign bytes in them are the business of who logs
/// them.
void append_escaped(spdlog::memory_buf_t& line, std::string_view text) {
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      line.push_back('\\');
      line.push_back(c);
    } else if (byte < 0x20 || byte == 0x7f) {
      append(line, fmt::format("\\u{:04x}", byte));
    } else {
      line.push_back(c);
    }
  }
}

std::string utc_time(spdlog::log_clock::time_point time) {
  using namespace std::chrono;
  const auto ms = duration_cast<milliseconds>(time.time_since_epoch()).count() % 1000;
  return fmt::format("{}.{:03}Z", utc_text(time, kUtcSeconds), ms);
}

class JsonLineFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    append(line, "{\"time\": \"" + utc_time(message.time) + "\", \"level\": \"");
    const auto level = spdlog::level::to_string_view(message.level);
    append(line, {level.data(), level.size()});
    append(line, "\", \"message\": \"");
    append_escaped(line, {message.payload.data(), message.payload.size()});
    append(line, "\"}\n");
  }
  std::unique_ptr<formatter> clone() const override { return std::make_unique<JsonLineFormatter>(); }
};

}  // namespace

std::unique_ptr<spdlog::formatter> json_line_formatter() { return std::make_unique<JsonLineFormatter>(); }

void start_logging(const LogConfig& config) {
  auto logger =
      std::make_shared<spdlog::logger>("calibrd", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  if (config.format == "json")
    logger->set_formatter(json_line_formatter());
  else
    logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
  logger->set_level(spdlog::level::from_str(config.level));
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace calibrd
