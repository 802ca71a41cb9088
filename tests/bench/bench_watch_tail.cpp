// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Innovations of sensors that stand, through the test alone: in blocks as they came, and drawn from these at
// random for as many hours as one likes.
#include <boost/json.hpp>
#include <cstdio>

#include "drivers/sim/world/random.hpp"
#include "tests/bench/innovations.hpp"
#include "tests/bench/running_cell.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

constexpr double kLeastPeak = 0.1;  // smaller ones say nothing of the tail
/// Of the tolerance. With less of it the statistic is nowhere smaller, so that its alarms bound those of the
/// test, also where the test itself shows no peak to judge by.
constexpr double kShares[] = {1, 0.8, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1};

struct Block {
  std::size_t begin = 0, end = 0;
};

/// Pieces of one cell each, `block_s` long; what is left over of a cell is part of none.
std::vector<Block> blocks_of(const std::vector<RecordedInnovation>& all, double block_s) {
  std::vector<Block> blocks;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].cell != all[begin].cell) begin = i;
    if (all[i].stamp_s - all[begin].stamp_s < block_s) continue;
    blocks.push_back({begin, i});
    begin = i;
  }
  return blocks;
}

/// The largest values between two times at which the statistic was 0.
class Peaks {
 public:
  void add(double statistic) {
    peak_ = std::max(peak_, statistic);
    if (statistic > 0) return;
    end();
  }
  void end() {
    if (peak_ >= kLeastPeak) found_.push_back(peak_);
    peak_ = 0;
  }
  const std::vector<double>& found() const { return found_; }

 private:
  double peak_ = 0;
  std::vector<double> found_;
};

void feed(ShiftTest& test, const RecordedInnovation& one) {
  test.add(one.innovation.supported_shift, one.innovation.supported_covariance, one.innovation.common_share);
}

ShiftTestSettings with_tolerance(double share) {
  ShiftTestSettings settings;
  settings.tolerance_m *= share;
  settings.tolerance_rad *= share;
  return settings;
}

json::array peaks_of(const std::vector<RecordedInnovation>& all, const Block& block, double share) {
  ShiftTest test(with_tolerance(share));
  Peaks peaks;
  for (std::size_t i = block.begin; i < block.end; ++i) {
    feed(test, all[i]);
    peaks.add(test.statistic());
  }
  peaks.end();
  return json::value_from(peaks.found()).as_array();
}

json::object measured(const std::vector<RecordedInnovation>& all, const Block& block) {
  json::array peaks;
  for (const double share : kShares)
    peaks.push_back({{"tolerance_share", share}, {"peaks", peaks_of(all, block, share)}});
  return {{"cell", all[block.begin].cell}, {"frames", block.end - block.begin}, {"tails", peaks}};
}

json::object resampled(const std::vector<RecordedInnovation>& all, const std::vector<Block>& blocks,
                       const WatchTailOptions& options) {
  sim::Random random(options.seed);
  const auto frames = static_cast<std::uint64_t>(options.hours * 3600 * RunningCell::kRate_hz);
  ShiftTest test{ShiftTestSettings{}};
  double largest = 0;
  std::uint64_t seen = 0, alarms = 0;
  while (seen < frames) {
    const Block& block = blocks[random.bits() % blocks.size()];
    for (std::size_t i = block.begin; i < block.end; ++i, ++seen) {
      feed(test, all[i]);
      largest = std::max(largest, test.statistic());
      if (!test.is_alarmed()) continue;
      ++alarms;
      test.reset();
    }
  }
  return {{"resampled_h", static_cast<double>(seen) / RunningCell::kRate_hz / 3600},
          {"blocks", blocks.size()},
          {"block_s", options.block_s},
          {"alarms", alarms},
          {"largest", largest},
          {"threshold", test.threshold()}};
}

}  // namespace

int run_watch_tail(const WatchTailOptions& options) {
  std::vector<RecordedInnovation> all;
  for (const auto& path : options.innovations) {
    const auto some = read_innovations(path);
    all.insert(all.end(), some.begin(), some.end());
  }
  const auto blocks = blocks_of(all, options.block_s);
  if (blocks.empty()) {
    std::fprintf(stderr, "calibrd-bench: not one block of %.0f s in these files\n", options.block_s);
    return 2;
  }
  for (const Block& block : blocks) std::printf("%s\n", json::serialize(measured(all, block)).c_str());
  std::printf("%s\n", json::serialize(resampled(all, blocks, options)).c_str());
  return 0;
}

}  // namespace calibrd::bench
