// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/robot_word.hpp"

#include <algorithm>
#include <cmath>

#include "core/drift/same_posture.hpp"

namespace calibrd {
namespace {

constexpr double kOff_s = 0.5;  // one comparison alone says nothing of a second
/// A comparison of a good model stays below 2.2 standard deviations of what noise, model and joint zeros
/// explain, in nearly every posture.
constexpr double kAllowance = 2.7, kPostureWeight = 2;
constexpr double kMostPerWord = 4;
/// What comparisons in one motion, in which its frames and joints may lag, have against a pose is one word.
constexpr double kLeastDoubt_s = 1;
constexpr std::size_t kMostDoubts = 6;
constexpr double kUnexplained = 6;  // standard deviations, where so little agrees that none can be told

}  // namespace

void RobotWord::add(const PoseCheck& check, std::span<const double> joints, double now_s) {
  if (!check.enough_evidence) return;
  if (!is_same_posture(posture_, joints)) {
    if (statistic_ > 0) doubts_.push_back(*newest_);
    if (statistic_ <= 0) doubts_.clear();
    if (doubts_.size() > kMostDoubts) doubts_.erase(doubts_.begin());
    posture_.assign(joints.begin(), joints.end());
    before_posture_ = std::min(statistic_, kLimit);  // what is mended shows soon
    posture_sigmas_ = posture_checks_ = 0;
    mean_.end_posture(now_s);
  }
  newest_ = check;
  stamp_s_ = now_s;
  mean_.add(check, joints, now_s);
  const double sigmas = check.agrees || check.shift_sigmas > 0 ? check.shift_sigmas : kUnexplained;
  ++posture_checks_;
  posture_sigmas_ += (sigmas - posture_sigmas_) / posture_checks_;
  const double word =
      std::clamp(kPostureWeight * (posture_sigmas_ - kAllowance), -kMostPerWord, kMostPerWord);
  if (statistic_ <= 0) doubt_since_s_ = now_s;
  statistic_ = std::max(0.0, before_posture_ + word);
}

bool RobotWord::agrees_within(double seconds, double now_s) const {
  return newest_ && newest_->agrees && age_s(now_s) < seconds;
}

bool RobotWord::agrees_since(double since_s, double now_s) const {
  return agrees_within(kOfNow_s, now_s) && stamp_s_ > since_s;
}

bool RobotWord::is_off(double now_s) const { return newest_ && !newest_->agrees && age_s(now_s) < kOff_s; }

std::optional<RobotShift> RobotWord::creep() const {
  const auto shift = mean_.shift();
  return shift && shift->sigmas > kCreepSigmas ? shift : std::nullopt;
}

double RobotWord::creep_doubt() const {
  const auto shift = mean_.shift();
  return shift ? shift->sigmas / kCreepSigmas : 0;
}

std::vector<PoseCheck> RobotWord::doubts() const {
  auto doubts = doubts_;
  if (newest_) doubts.push_back(*newest_);
  return doubts;
}

bool RobotWord::is_against() const {
  return statistic_ > kLimit && stamp_s_ - doubt_since_s_ >= kLeastDoubt_s;
}
bool RobotWord::is_against_no_more() const { return statistic_ < 0.5 * kLimit; }

}  // namespace calibrd
