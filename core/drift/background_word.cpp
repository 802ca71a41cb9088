// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/background_word.hpp"

namespace calibrd {
namespace {

constexpr double kNewestPinned = 0.1;  // weight of a frame
constexpr double kMost = 0.5;          // of the frames

}  // namespace

void BackgroundWord::add(bool is_pinned, bool is_finely_pinned, double now_s) {
  pinned_share_ += kNewestPinned * ((is_pinned ? 1 : 0) - pinned_share_);
  if (!is_pinned || pinned_share_ < kMost) return;
  pinned_s_ = now_s;
  if (is_finely_pinned) finely_pinned_s_ = now_s;
}

}  // namespace calibrd
