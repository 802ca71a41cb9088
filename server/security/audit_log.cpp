// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/audit_log.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <cerrno>
#include <chrono>
#include <system_error>

#include "core/base/utc_text.hpp"

namespace calibrd {
namespace {

const char* result_of(int status) {
  if (status < 400) return "done";
  return status < 500 ? "refused" : "failed";
}

std::string now_text() {
  using namespace std::chrono;
  const auto now = system_clock::now();
  const auto ms = duration_cast<milliseconds>(now.time_since_epoch()).count() % 1000;
  auto digits = std::to_string(1000 + ms);
  digits[0] = '.';
  return utc_text(now, kUtcSeconds) + digits + "Z";
}

}  // namespace

std::string audit_line(const api::AuditRecord& record) {
  boost::json::object line{{"time", now_text()},
                           {"who", record.who},
                           {"from", record.address},
                           {"request", record.request_id},
                           {"what", record.method + " " + record.path},
                           {"status", record.status},
                           {"result", result_of(record.status)}};
  if (!record.location.empty()) line["made"] = record.location;
  return boost::json::serialize(line) + "\n";
}

std::string audit_line(const OwnChange& change) {
  boost::json::object line{{"time", now_text()},
                           {"who", change.who},
                           {"what", change.what},
                           {"result", change.is_done ? "done" : "refused"}};
  if (!change.made.empty()) line["made"] = change.made;
  if (!change.detail.empty()) line["detail"] = change.detail;
  return boost::json::serialize(line) + "\n";
}

AuditLog::AuditLog(AuditSettings settings, std::function<void(const std::string&)> on_failure)
    : settings_(std::move(settings)),
      on_failure_(std::move(on_failure)),
      writer_([this](const std::stop_token& stopped) { write_noted(stopped); }) {}

AuditLog::~AuditLog() {
  writer_.request_stop();
  writer_.join();
  if (descriptor_ >= 0) ::close(descriptor_);
}

void AuditLog::write(const api::AuditRecord& record) { write_line(audit_line(record)); }

void AuditLog::note(const OwnChange& change) {
  {
    const std::lock_guard lock(noting_);
    noted_.push_back(audit_line(change));
  }
  is_noted_.notify_one();
}

void AuditLog::write_noted(const std::stop_token& stopped) {
  std::unique_lock lock(noting_);
  while (is_noted_.wait(lock, stopped, [this] { return !noted_.empty(); }) || !noted_.empty()) {
    const auto line = std::move(noted_.front());
    noted_.pop_front();
    lock.unlock();
    write_line(line);
    lock.lock();
  }
}

void AuditLog::write_line(const std::string& line) {
  const std::lock_guard lock(mutex_);
  if (append(line)) return;
  const auto why = std::generic_category().message(errno);
  on_failure_(
      "the audit log " + settings_.file.string() + " cannot be written (" + why +
      "); check the disk and its permissions. What should stand there: " + line.substr(0, line.size() - 1));
}

bool AuditLog::append(const std::string& line) {
  if (descriptor_ < 0 && !open()) return false;
  if (bytes_ > 0 && bytes_ + line.size() > settings_.max_bytes && !rotate()) return false;
  const auto written = ::write(descriptor_, line.data(), line.size());
  if (written == static_cast<ssize_t>(line.size()) && ::fdatasync(descriptor_) == 0) {
    bytes_ += line.size();
    return true;
  }
  const int why = written >= 0 && written < static_cast<ssize_t>(line.size()) ? ENOSPC : errno;
  // Half a line would spoil the next one.
  if (written > 0 && ::ftruncate(descriptor_, static_cast<off_t>(bytes_)) != 0)
    bytes_ += static_cast<std::uint64_t>(written);
  errno = why;
  return false;
}

bool AuditLog::open() {
  descriptor_ = ::open(settings_.file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  struct stat seen {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &seen) != 0) return false;
  bytes_ = static_cast<std::uint64_t>(seen.st_size);
  return true;
}

/// audit.jsonl becomes audit.1.jsonl, that audit.2.jsonl, and the last goes.
bool AuditLog::rotate() {
  ::close(descriptor_);
  descriptor_ = -1;
  for (int number = settings_.files - 1; number > 0; --number) {
    const auto from = number == 1 ? settings_.file : older(number - 1);
    if (::rename(from.c_str(), older(number).c_str()) != 0 && errno != ENOENT) return false;
  }
  if (settings_.files == 1 && ::unlink(settings_.file.c_str()) != 0) return false;
  return open();
}

std::filesystem::path AuditLog::older(int number) const {
  auto file = settings_.file;
  const auto ending =
      std::string(".").append(std::to_string(number)).append(settings_.file.extension().string());
  return file.replace_extension(ending);
}

}  // namespace calibrd
