// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/export_window.hpp"

#include <utility>

namespace calibrd::fleet {
namespace {

constexpr std::chrono::seconds kFirstPause{15}, kLastPause{300};

}  // namespace

/// What waits of an earlier one goes on being sent: a collector may store it although the database is lost.
void ExportWindow::follow(std::uint64_t generation) {
  if (std::exchange(generation_, generation) != generation) newest_ = 0;
}

void ExportWindow::add(std::int64_t number, std::string id, std::string payload) {
  newest_ = std::max(newest_, number);
  waiting_.try_emplace(std::move(id), Row{std::move(payload), number});
}

std::vector<std::string> ExportWindow::take_due(Time now) {
  std::vector<std::string> due;
  for (auto& [id, row] : waiting_) {
    if (row.due > now) continue;
    due.push_back(row.payload);
    row.pause = row.pause.count() == 0 ? kFirstPause : std::min(2 * row.pause, kLastPause);
    row.due = now + row.pause;
  }
  return due;
}

void ExportWindow::send_all_again() {
  for (auto& [id, row] : waiting_) row.pause = std::chrono::seconds(0), row.due = Time{};
}

void ExportWindow::begin_anew() {
  newest_ = 0;
  send_all_again();
}

bool ExportWindow::drop(const std::string& id) { return waiting_.erase(id) > 0; }

}  // namespace calibrd::fleet
