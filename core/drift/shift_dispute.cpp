// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/shift_dispute.hpp"

#include <algorithm>

namespace calibrd {
namespace {

constexpr double kNewest = 1.0 / 30;  // weight of a frame in the mean
constexpr double kEnds_s = 1;
constexpr double kSame_m = 1e-3, kSame_rad = 1e-3;
/// What one posture can say at most, and all together; what denies, and what several must say to affirm.
constexpr double kMostPerPosture = 4, kMostHeard = 12, kDenied = 2, kAffirmed = 9;
constexpr int kAffirmingPostures = 3;
/// Comparisons in one motion, in which frames and joints may lag, err alike, too.
constexpr double kLeastAffirmed_s = 1.5;
/// What comes and goes so quickly is one dispute; later it may be another thing that looks the same.
constexpr double kSameDispute_s = 10;

bool is_same(const Vector6d& a, const Vector6d& b) {
  const Vector6d since = a - b;
  return since.head<3>().norm() < kSame_rad && since.tail<3>().norm() < kSame_m;
}

}  // namespace

void ShiftDispute::add(const CellWindow& window, const Vector6d& turn_shift, double now_s) {
  window_ = window;
  if (!is_open()) {
    if (now_s - seen_s_ > kSameDispute_s) heard_ = {};
    since_s_ = now_s;
    turn_shift_ = turn_shift;
  }
  seen_s_ = now_s;
  turn_shift_ += kNewest * (turn_shift - turn_shift_);
}

double ShiftDispute::voice() const { return std::clamp(heard_.mean, -kMostPerPosture, kMostPerPosture); }

void ShiftDispute::hear(double preference, int posture, double now_s) {
  if (heard_.comparisons > 0 && !is_same(turn_shift_, heard_.of)) heard_ = {};
  if (heard_.comparisons == 0) {
    heard_.of = turn_shift_;
    heard_.since_s = now_s;
  }
  heard_.newest_s = now_s;
  if (posture != heard_.posture) {
    heard_.before = std::clamp(heard(), -kMostHeard, kMostHeard);
    heard_.posture = posture;
    heard_.mean = 0;
    heard_.comparisons = 0;
    ++heard_.postures;
  }
  ++heard_.comparisons;
  heard_.mean += (preference - heard_.mean) / heard_.comparisons;
}

bool ShiftDispute::is_denied() const { return heard() >= kDenied && is_same(turn_shift_, heard_.of); }

bool ShiftDispute::is_affirmed() const {
  return is_open() && heard() <= -kAffirmed && heard_.postures >= kAffirmingPostures &&
         heard_.newest_s - heard_.since_s >= kLeastAffirmed_s;
}

void ShiftDispute::add_none(double now_s) {
  if (now_s - seen_s_ > kEnds_s) since_s_ = -1;
}

}  // namespace calibrd
