// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/shift_dispute.hpp"

namespace calibrd {
namespace {

constexpr double kNewest = 1.0 / 30;  // weight of a frame in the mean
constexpr double kEnds_s = 1;
constexpr double kSame_m = 1e-3, kSame_rad = 1e-3;

}  // namespace

void ShiftDispute::add(const CellWindow& window, const Vector6d& turn_shift, double now_s) {
  window_ = window;
  seen_s_ = now_s;
  if (!is_open()) {
    since_s_ = now_s;
    turn_shift_ = turn_shift;
    denied_.reset();
  }
  turn_shift_ += kNewest * (turn_shift - turn_shift_);
}

bool ShiftDispute::is_denied() const {
  if (!denied_) return false;
  const Vector6d since = turn_shift_ - *denied_;
  return since.head<3>().norm() < kSame_rad && since.tail<3>().norm() < kSame_m;
}

void ShiftDispute::add_none(double now_s) {
  if (now_s - seen_s_ > kEnds_s) since_s_ = -1;
}

}  // namespace calibrd
