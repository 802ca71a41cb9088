// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/process_metrics.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace calibrd {
namespace {

/// The fields of /proc/self/stat after the program's name, which may hold anything: [0] is field 3 of
/// proc(5).
std::vector<double> stat_fields() {
  std::stringstream file;
  file << std::ifstream("/proc/self/stat").rdbuf();
  const auto text = file.str();
  const auto name_end = text.rfind(')');
  std::vector<double> fields;
  if (name_end == std::string::npos) return fields;
  std::istringstream rest(text.substr(name_end + 1));
  for (std::string word; rest >> word;) fields.push_back(std::strtod(word.c_str(), nullptr));
  return fields;
}

/// Unix time of the machine's start.
std::optional<double> boot_time_s() {
  std::ifstream file("/proc/stat");
  for (std::string word; file >> word;) {
    double seconds = 0;
    if (word == "btime" && file >> seconds) return seconds;
  }
  return std::nullopt;
}

std::optional<double> open_files() {
  std::error_code failure;
  double count = 0;
  std::filesystem::directory_iterator entry("/proc/self/fd", failure);
  for (; !failure && entry != std::filesystem::directory_iterator(); entry.increment(failure)) ++count;
  if (failure) return std::nullopt;
  return count - 1;  // without the one that reads the folder
}

void write(api::MetricsText& text, const char* family, std::optional<double> value) {
  text.begin(family);
  if (value) text.add({}, *value);
}

}  // namespace

void write_process_metrics(api::MetricsText& text) {
  // Places in the list above: utime and stime, num_threads, starttime, vsize, rss.
  constexpr std::size_t kUser = 11, kSystem = 12, kThreads = 17, kStart = 19, kVirtual = 20, kResident = 21;
  const auto fields = stat_fields();
  const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK)),
             page = static_cast<double>(sysconf(_SC_PAGESIZE));
  const auto of = [&](std::size_t place) {
    return place < fields.size() ? std::optional(fields[place]) : std::nullopt;
  };
  const auto boot = boot_time_s();
  const bool known = fields.size() > kResident;
  rlimit files{};
  const bool limited = getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur != RLIM_INFINITY;
  write(text, "process_cpu_seconds_total",
        known ? std::optional((fields[kUser] + fields[kSystem]) / ticks) : std::nullopt);
  write(text, "process_resident_memory_bytes",
        known ? std::optional(fields[kResident] * page) : std::nullopt);
  write(text, "process_virtual_memory_bytes", of(kVirtual));
  write(text, "process_open_fds", open_files());
  write(text, "process_max_fds", limited ? std::optional(static_cast<double>(files.rlim_cur)) : std::nullopt);
  write(text, "process_threads", of(kThreads));
  write(text, "process_start_time_seconds",
        boot && known ? std::optional(*boot + fields[kStart] / ticks) : std::nullopt);
}

}  // namespace calibrd
