// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/storage/scripted_work.hpp"

#include <sqlite3.h>

#include "tests/server/storage/allocation_faults.hpp"

namespace calibrd {
namespace {

constexpr const char* kSensor = "kinect2";

api::CalibrationReport report_of(const std::string& id) {
  api::CalibrationReport report;
  report.id = id;
  report.sensor_id = kSensor;
  report.created = report.finished.emplace(std::chrono::system_clock::now());
  report.status = api::JobStatus::succeeded;
  report.result.emplace();
  report.result->verdict = Verdict::accepted;
  report.result->T_base_sensor = Pose(Eigen::Translation3d(1, 2, static_cast<double>(id.size())));
  return report;
}

}  // namespace

/// A call of the store: what fails there must come back as an error.
template <class Call>
static auto ask(const Call& call) {
  const AllocationsCount counted;
  return call();
}

bool ScriptedWork::note(const Status& status) {
  if (!status) errors_.push_back(status.error());
  return status.has_value();
}

bool ScriptedWork::reopen() {
  store_.reset();
  auto opened = ask([&] { return CalibrationStore::open(file_, vfs_); });
  if (!opened) return note(opened.error());
  store_ = *std::move(opened);
  return true;
}

bool ScriptedWork::calibrate(const std::string& id, bool activate) {
  const auto report = report_of(id);
  if (!note(ask([&] { return store_->add(report, {}); }))) return false;
  added_.insert(id);
  if (activate) maybe_current_.insert(id);
  const auto basis = activate ? std::optional<std::string>("fx 365") : std::nullopt;
  if (!note(ask([&] { return store_->finish(report, basis); }))) return false;
  finished_.insert(id);
  if (activate) current_ = id, maybe_current_.clear();
  return true;
}

void ScriptedWork::activate(const std::string& id) {
  maybe_current_.insert(id);
  const auto report = report_of(id);
  if (!finished_.contains(id) || !note(ask([&] { return store_->activate(report, "fx 366"); }))) return;
  current_ = id;
  maybe_current_.clear();
  drifted_.clear();
}

void ScriptedWork::drift(const std::string& id) {
  if (current_ == id && note(ask([&] { return store_->add_drift(id); }))) drifted_.insert(id);
}

void ScriptedWork::add_background(const std::string& id) {
  const std::vector<float> depth_m(3000, 1.5F);
  if (finished_.contains(id) && note(ask([&] { return store_->add_background(id, depth_m); })))
    backgrounds_.insert(id);
}

void ScriptedWork::read_all() {
  const api::HistoryQuery query{kSensor, 10, ""};
  const std::string a = "a", b = "b", sensor = kSensor;
  if (const auto page = ask([&] { return store_->history(query); }); !page) note(page.error());
  if (const auto found = ask([&] { return store_->find(a); }); !found) note(found.error());
  if (const auto current = ask([&] { return store_->current(sensor); }); !current) note(current.error());
  if (const auto depths = ask([&] { return store_->background(b); }); !depths) note(depths.error());
}

void ScriptedWork::run() {
  if (reopen()) {
    calibrate("a", true);
    add_background("a");
    calibrate("b", false);
    add_background("b");
    activate("b");
    drift("b");
  }
  if (reopen()) {
    calibrate("c", true);
    read_all();
    activate("a");
    if (const auto report = report_of("interrupted"); note(ask([&] { return store_->add(report, {}); })))
      added_.insert(report.id);
  }
  if (reopen()) {
    drift("a");
    calibrate("d", false);
    read_all();
  }
}

bool ScriptedWork::add_current(const std::string& id) {
  if (!store_ && !reopen()) return false;
  store_->look();
  return calibrate(id, true);
}

std::vector<std::string> ScriptedWork::broken_promises(const std::filesystem::path& file) const {
  std::vector<std::string> broken;
  const auto store = CalibrationStore::open(file);
  if (!store) return {"opens: " + store.error().message()};
  for (const auto& id : added_)
    if (const auto found = (*store)->find(id); !found || !*found) broken.push_back(id + " is there");
  for (const auto& id : finished_) {
    const auto found = (*store)->find(id);
    const bool is_whole =
        found && *found && (*found)->status == api::JobStatus::succeeded && (*found)->result;
    if (!is_whole || (*found)->result->T_base_sensor->translation().y() != 2)
      broken.push_back(id + " has its result");
  }
  const auto current = (*store)->current(kSensor);
  const auto id = current && *current ? (*current)->calibration.id : std::string();
  if (id != current_ && !maybe_current_.contains(id)) broken.push_back(current_ + " is current, not " + id);
  if (drifted_.contains(id) && id == current_ && !maybe_current_.contains(id) && !(*current)->drifted)
    broken.push_back(id + " has drifted");
  for (const auto& kept : backgrounds_)
    if (const auto background = (*store)->background(kept); !background || !*background)
      broken.push_back(kept + " has its background");
  return broken;
}

std::string integrity_of(const std::filesystem::path& file) {
  sqlite3* connection = nullptr;
  sqlite3_open(file.c_str(), &connection);
  std::string words;
  sqlite3_exec(
      connection, "PRAGMA integrity_check",
      [](void* to, int, char** values, char**) {
        *static_cast<std::string*>(to) += values[0];
        return 0;
      },
      &words, nullptr);
  if (words.empty()) words = sqlite3_errmsg(connection);
  sqlite3_close(connection);
  return words;
}

}  // namespace calibrd
