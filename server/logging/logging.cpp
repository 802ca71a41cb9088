// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/logging/logging.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "core/base/log_scope.hpp"
#include "core/base/utc_text.hpp"
#include "server/logging/log_ring.hpp"

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
    append(line, "\"");
    append_mark(line, "request_id", log_marks().request_id);
    append_mark(line, "job_id", log_marks().job_id);
    append(line, "}\n");
  }
  std::unique_ptr<formatter> clone() const override { return std::make_unique<JsonLineFormatter>(); }

 private:
  static void append_mark(spdlog::memory_buf_t& line, std::string_view name, std::string_view value) {
    if (value.empty()) return;
    append(line, fmt::format(", \"{}\": \"", name));
    append_escaped(line, value);
    append(line, "\"");
  }
};

class MarksFlag final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg&, const std::tm&, spdlog::memory_buf_t& line) override {
    const auto& marks = log_marks();
    if (!marks.request_id.empty()) append(line, fmt::format(" [request {}]", marks.request_id));
    if (!marks.job_id.empty()) append(line, fmt::format(" [job {}]", marks.job_id));
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<MarksFlag>(); }
};

std::shared_ptr<LogRing>& ring() {
  static std::shared_ptr<LogRing> newest;
  return newest;
}

}  // namespace

std::unique_ptr<spdlog::formatter> json_line_formatter() { return std::make_unique<JsonLineFormatter>(); }

std::unique_ptr<spdlog::formatter> text_line_formatter() {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<MarksFlag>('*').set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v%*");
  return formatter;
}

std::string newest_log_lines() { return ring() ? ring()->text() : std::string(); }

void start_logging(const LogConfig& config) {
  ring() = std::make_shared<LogRing>();
  const spdlog::sinks_init_list sinks{std::make_shared<spdlog::sinks::stderr_sink_mt>(), ring()};
  auto logger = std::make_shared<spdlog::logger>("calibrd", sinks);
  logger->set_formatter(config.format == "json" ? json_line_formatter() : text_line_formatter());
  logger->set_level(spdlog::level::from_str(config.level));
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(std::move(logger));
}

void set_log_level(const std::string& level) { spdlog::set_level(spdlog::level::from_str(level)); }

}  // namespace calibrd
