// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/shift_dispute.hpp"

#include <algorithm>

#include "core/drift/same_posture.hpp"

namespace calibrd {
namespace {

constexpr double kNewestShift = 1.0 / 30;  // weight of a frame in the mean
/// Noise alone looks like it in one frame of twenty: most of the last frames must, and few end it.
constexpr double kOfFrames = 0.1, kOpens = 0.5, kEnds = 0.2;
constexpr double kSame_m = 1e-3, kSame_rad = 1e-3;
/// What one posture can say at most; what denies, and what several must say to affirm. Only the newest
/// postures are heard.
constexpr double kMostPerPosture = 4, kDenied = 2, kAffirmed = 9;
constexpr std::size_t kMostVoices = 12;
constexpr std::size_t kAffirmingPostures = 3;
/// Comparisons in one motion, in which frames and joints may lag, err alike, too.
constexpr double kLeastAffirmed_s = 1.5;
/// What comes and goes so quickly is one dispute; later it may be another thing that looks the same.
constexpr double kSameDispute_s = 10;

bool is_same(const Vector6d& a, const Vector6d& b) {
  const Vector6d since = a - b;
  return since.head<3>().norm() < kSame_rad && since.tail<3>().norm() < kSame_m;
}

}  // namespace

void ShiftDispute::follow(const Vector6d& turn_shift) {
  ++frames_;
  turn_shift_ += std::max(kNewestShift, 1.0 / frames_) * (turn_shift - turn_shift_);
}

void ShiftDispute::add(const CellWindow& window, const Vector6d& turn_shift, double now_s) {
  if (share_ < kEnds && !is_open()) frames_ = 0;
  share_ += kOfFrames * (1 - share_);
  window_ = window;
  follow(turn_shift);
  if (is_open() || share_ < kOpens) return;
  if (now_s - ended_s_ > kSameDispute_s) heard_ = {};
  since_s_ = now_s;
}

double ShiftDispute::heard() const {
  double sum = 0;
  for (const Voice& voice : heard_.voices) sum += std::clamp(voice.mean, -kMostPerPosture, kMostPerPosture);
  return sum;
}

void ShiftDispute::hear(double preference, std::span<const double> joints, double now_s) {
  if (!heard_.voices.empty() && !is_same(turn_shift_, heard_.of)) heard_ = {};
  if (heard_.voices.empty()) {
    heard_.of = turn_shift_;
    heard_.since_s = now_s;
  }
  heard_.newest_s = now_s;
  auto voice = std::ranges::find_if(
      heard_.voices, [&](const Voice& other) { return is_same_posture(other.joints, joints); });
  if (voice == heard_.voices.end()) {
    if (heard_.voices.size() == kMostVoices) heard_.voices.erase(heard_.voices.begin());
    voice = heard_.voices.insert(heard_.voices.end(), {{joints.begin(), joints.end()}});
  }
  ++voice->comparisons;
  voice->mean += (preference - voice->mean) / voice->comparisons;
}

bool ShiftDispute::is_denied() const { return heard() >= kDenied && is_same(turn_shift_, heard_.of); }

bool ShiftDispute::is_affirmed() const {
  return is_open() && heard() <= -kAffirmed && heard_.voices.size() >= kAffirmingPostures &&
         heard_.newest_s - heard_.since_s >= kLeastAffirmed_s;
}

void ShiftDispute::add_none(const Vector6d& turn_shift, double now_s) {
  share_ -= kOfFrames * share_;
  follow(turn_shift);
  if (share_ < kEnds && is_open()) settle(now_s);
}

}  // namespace calibrd
