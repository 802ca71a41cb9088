// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/shift_dispute.hpp"

namespace calibrd {
namespace {

constexpr double kNewest = 1.0 / 30;  // weight of a frame in the mean
constexpr double kEnds_s = 1;

}  // namespace

void ShiftDispute::add(const CellWindow& window, const Vector6d& turn_shift, double now_s) {
  window_ = window;
  seen_s_ = now_s;
  if (!is_open()) {
    since_s_ = now_s;
    turn_shift_ = turn_shift;
  }
  turn_shift_ += kNewest * (turn_shift - turn_shift_);
}

void ShiftDispute::add_none(double now_s) {
  if (now_s - seen_s_ > kEnds_s) since_s_ = -1;
}

}  // namespace calibrd
