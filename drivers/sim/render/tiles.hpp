// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace calibrd::sim {

inline constexpr int kTile_px = 16;

/// A rectangle of pixels; x1 and y1 are one past the last.
struct PixelRect {
  int x0, y0, x1, y1;
};

/// Which parts of an image something has changed in.
class Tiles {
 public:
  Tiles(int width, int height)
      : width_(width),
        height_(height),
        columns_((width + kTile_px - 1) / kTile_px),
        rows_((height + kTile_px - 1) / kTile_px),
        marks_(static_cast<std::size_t>(columns_ * rows_), 0) {}

  void clear() { std::fill(marks_.begin(), marks_.end(), std::uint8_t{0}); }
  void mark_all() { std::fill(marks_.begin(), marks_.end(), std::uint8_t{1}); }
  void add(const Tiles& other) {
    for (std::size_t i = 0; i < marks_.size(); ++i) marks_[i] |= other.marks_[i];
  }

  /// Marks every tile that the rectangle touches.
  void mark(const PixelRect& rect) {
    const int c0 = std::max(rect.x0, 0) / kTile_px, c1 = std::min(rect.x1 - 1, width_ - 1) / kTile_px;
    const int r0 = std::max(rect.y0, 0) / kTile_px, r1 = std::min(rect.y1 - 1, height_ - 1) / kTile_px;
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c) marks_[static_cast<std::size_t>(r * columns_ + c)] = 1;
  }

  bool is_marked(int x, int y) const {
    return marks_[static_cast<std::size_t>(y / kTile_px * columns_ + x / kTile_px)] != 0;
  }

  /// Calls visit(PixelRect) for every marked tile.
  template <class Visit>
  void each(Visit visit) const {
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c)
        if (marks_[static_cast<std::size_t>(r * columns_ + c)] != 0)
          visit(PixelRect{c * kTile_px, r * kTile_px, std::min((c + 1) * kTile_px, width_),
                          std::min((r + 1) * kTile_px, height_)});
  }

 private:
  int width_, height_, columns_, rows_;
  std::vector<std::uint8_t> marks_;
};

}  // namespace calibrd::sim
