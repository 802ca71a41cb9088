// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// fleet_exporters: many daemons' exporters and stores, without their cells. Each calibration "ends" in the
// store of a cell as in the daemon; what then happens to it is the real thing.
//   fleet_exporters FOLDER CELLS BROKER_PORT PER_SECOND SECONDS DRAIN_SECONDS
// For SECONDS, PER_SECOND calibrations in all; then it waits until nothing waits, DRAIN_SECONDS at most.
// Prints one JSON object. A second run on the same folder goes on with what is in the stores.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <thread>

#include "fleet/exporter/exporter.hpp"
#include "server/storage/calibration_store.hpp"
#include "tests/api/fake_cell.hpp"

namespace {

using namespace calibrd;
using Steady = std::chrono::steady_clock;

volatile std::sig_atomic_t ending = 0;

/// How long each calibration took from its end in the store to its acknowledgement, all in.
class Delays {
 public:
  void began(const std::string& id) {
    const std::lock_guard lock(mutex_);
    began_[id] = Steady::now();
  }
  void ended(const std::string& id) {
    const std::lock_guard lock(mutex_);
    const auto found = began_.find(id);
    if (found == began_.end()) return;
    all_.push_back(std::chrono::duration<double>(Steady::now() - found->second).count());
    began_.erase(found);
  }
  double quantile(double share) {
    const std::lock_guard lock(mutex_);
    if (all_.empty()) return 0;
    std::sort(all_.begin(), all_.end());
    return all_[std::min(all_.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(all_.size())))];
  }
  std::size_t count() {
    const std::lock_guard lock(mutex_);
    return all_.size();
  }

 private:
  std::mutex mutex_;
  std::map<std::string, Steady::time_point> began_;
  std::vector<double> all_;
};

class StoreOutbox final : public fleet::Outbox {
 public:
  StoreOutbox(CalibrationStore& store, Delays& delays) : store_(store), delays_(delays) {}

  std::uint64_t generation() const override { return store_.outbox_generation(); }
  Result<std::vector<fleet::OutboxRow>> waiting(std::int64_t after, int limit) override {
    auto entries = store_.outbox(after, limit);
    if (!entries) return entries.error();
    std::vector<fleet::OutboxRow> rows;
    for (auto& entry : *entries) rows.push_back({entry.number, std::move(entry.calibration)});
    return rows;
  }
  Result<std::int64_t> size() override { return store_.outbox_size(); }
  Status remove(const std::vector<std::string>& ids) override {
    auto removed = store_.remove_from_outbox(ids);
    if (removed)
      for (const auto& id : ids) delays_.ended(id);
    return removed;
  }

 private:
  CalibrationStore& store_;
  Delays& delays_;
};

struct Cell {
  std::unique_ptr<CalibrationStore> store;
  std::unique_ptr<api::FakeCell> service = std::make_unique<api::FakeCell>();
  std::unique_ptr<StoreOutbox> outbox;
  std::unique_ptr<fleet::ExporterWatch> watch = std::make_unique<fleet::ExporterWatch>();
  std::unique_ptr<fleet::Exporter> exporter;
};

Cell make_cell(const std::filesystem::path& folder, int number, int port, Delays& delays) {
  Cell cell;
  const auto name = "cell-" + std::to_string(number);
  auto store = CalibrationStore::open(folder / name / "calibrd.db");
  if (!store) throw std::runtime_error(store.error().message());
  cell.store = *std::move(store);
  cell.service->make_calibrated();
  cell.service->pose_report.max_unverified = api::Seconds(24 * 3600);
  cell.outbox = std::make_unique<StoreOutbox>(*cell.store, delays);
  fleet::ExporterSettings settings;
  settings.broker.host = "127.0.0.1";
  settings.broker.port = port;
  settings.cell = name;
  settings.version = "test";
  auto exporter = fleet::Exporter::start(
      settings, *cell.service, *cell.outbox, [](const std::string&, bool) {}, *cell.watch);
  if (!exporter) throw std::runtime_error(exporter.error().message());
  cell.exporter = *std::move(exporter);
  return cell;
}

bool end_a_calibration(Cell& cell, const std::string& id, Delays& delays) {
  auto report = cell.service->calibration_report;
  report.id = id;
  report.created = std::chrono::system_clock::now();
  report.finished = report.created;
  report.status = api::JobStatus::succeeded;
  report.result = cell.service->pose_report.known->result;
  if (!cell.store->add(report, {})) return false;
  delays.began(id);
  if (!cell.store->finish(report)) return false;
  cell.exporter->wake();
  return true;
}

long resident_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
  return 0;
}

bool is_drained(std::vector<Cell>& cells) {
  return std::all_of(cells.begin(), cells.end(), [](Cell& cell) {
    const auto left = cell.store->outbox(0, 1);
    return left && left->empty();
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  const int count = std::stoi(argv[2]), port = std::stoi(argv[3]);
  const double per_second = std::stod(argv[4]), seconds = std::stod(argv[5]), patience = std::stod(argv[6]);
  std::signal(SIGTERM, [](int) { ending = 1; });
  Delays delays;
  std::vector<Cell> cells;
  const auto run = std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  for (int i = 0; i < count; ++i) cells.push_back(make_cell(argv[1], i, port, delays));
  const auto begin = Steady::now();
  const auto after = [&](double s) {
    return begin + std::chrono::duration_cast<Steady::duration>(std::chrono::duration<double>(s));
  };
  long made = 0;
  for (; ending == 0 && Steady::now() < after(seconds); ++made) {
    auto& cell = cells[static_cast<std::size_t>(made) % cells.size()];
    if (!end_a_calibration(cell, run + "-" + std::to_string(made), delays)) return 1;
    std::this_thread::sleep_until(after(static_cast<double>(made + 1) / per_second));
  }
  const double made_in = std::chrono::duration<double>(Steady::now() - begin).count();
  const auto end =
      Steady::now() + std::chrono::duration_cast<Steady::duration>(std::chrono::duration<double>(patience));
  while (ending == 0 && Steady::now() < end && !is_drained(cells))
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  std::printf(
      "{\"made\": %ld, \"seconds\": %.1f, \"acknowledged\": %zu, \"drained\": %s, \"delay_p50_s\": %.3f, "
      "\"delay_p99_s\": %.3f, "
      "\"resident_kb\": %ld}\n",
      made, made_in, delays.count(), is_drained(cells) ? "true" : "false", delays.quantile(0.5),
      delays.quantile(0.99), resident_kb());
  return 0;
}
