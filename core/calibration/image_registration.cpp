// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/image_registration.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace calibrd {
namespace {

constexpr int kReach_px = 32;  // outlines are moved this far ...
constexpr int kStep_px = 2;    // ... in steps of this
constexpr int kSame_px = 4;    // a place so near is not elsewhere
constexpr float kOutlineStep_m = 0.05F;
constexpr int kAround_px = 6;      // an edge is held against others so near
constexpr double kNoiseEdges = 4;  // ... and against this many times the image's noise

struct OutlinePoint {
  int x, y;
  float normal_x, normal_y;
};

std::size_t index_of(const CameraModel& camera, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
}

/// Pixels of the robot beside something much further away, with the direction to it.
std::vector<OutlinePoint> outline_of(const RegistrationView& view, const VirtualMeasurement& m,
                                     const CameraModel& camera) {
  constexpr int kMargin = 3, kRadius = 3;
  std::vector<OutlinePoint> points;
  for (int y = kMargin; y + kMargin < camera.height; ++y) {
    for (int x = kMargin; x + kMargin < camera.width; ++x) {
      const float z = m.depth_m[index_of(camera, x, y)];
      if (z <= 0 || (x + 2 * y) % 5 != 0) continue;
      const auto is_beyond = [&](int dx, int dy) {
        const float other = m.depth_m[index_of(camera, x + dx, y + dy)];
        return other <= 0 || other > z + kOutlineStep_m;
      };
      if (!is_beyond(1, 0) && !is_beyond(-1, 0) && !is_beyond(0, 1) && !is_beyond(0, -1)) continue;
      const float measured = view.depth_m[index_of(camera, x, y)];
      if (measured > 0 && measured < z - kOutlineStep_m) continue;  // hidden
      Eigen::Vector2f outward = Eigen::Vector2f::Zero();
      for (int dy = -kRadius; dy <= kRadius; ++dy)
        for (int dx = -kRadius; dx <= kRadius; ++dx)
          if (is_beyond(dx, dy)) outward += Eigen::Vector2f(static_cast<float>(dx), static_cast<float>(dy));
      if (outward.norm() < 1) continue;
      outward.normalize();
      points.push_back({x, y, outward.x(), outward.y()});
    }
  }
  return points;
}

/// Edges of an image, each as strong as it stands out among its neighbours: a bright lamp counts no more than
/// the rim of a link.
class EdgeImage {
 public:
  EdgeImage(const RegistrationView& view, const CameraModel& camera)
      : width_(camera.width), height_(camera.height), x_(view.image.size(), 0), y_(view.image.size(), 0) {
    std::vector<float> length(view.image.size(), 0);
    const auto row = static_cast<std::size_t>(width_);
    for (int y = 1; y + 1 < height_; ++y) {
      for (int x = 1; x + 1 < width_; ++x) {
        const std::size_t i = index_of(camera, x, y);
        x_[i] = 0.5F * (view.image[i + 1] - view.image[i - 1]);
        y_[i] = 0.5F * (view.image[i + row] - view.image[i - row]);
        length[i] = std::hypot(x_[i], y_[i]);
      }
    }
    const std::vector<float> strongest = greatest_around(length);
    const auto noise = static_cast<float>(kNoiseEdges * view.image_noise);
    for (std::size_t i = 0; i < length.size(); ++i) {
      x_[i] /= strongest[i] + noise;
      y_[i] /= strongest[i] + noise;
    }
  }

  /// The strongest edge across the normal within a pixel of the place, 0..1; below 0 outside of the image.
  float near(int x, int y, float nx, float ny) const {
    float best = -1;
    for (const int s : {-1, 0, 1}) {
      const int u = x + static_cast<int>(std::lround(static_cast<float>(s) * nx));
      const int v = y + static_cast<int>(std::lround(static_cast<float>(s) * ny));
      if (u < 1 || v < 1 || u + 1 >= width_ || v + 1 >= height_) continue;
      const auto i =
          static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
      best = std::max(best, std::abs(x_[i] * nx + y_[i] * ny));
    }
    return best;
  }

  int mirrored_x(int x) const { return width_ - 1 - x; }

 private:
  std::vector<float> greatest_around(const std::vector<float>& values) const {
    return greatest_along(greatest_along(values, 1, width_, height_), width_, height_, width_);
  }

  /// Running maximum along lines of `count` values that lie `step` apart.
  std::vector<float> greatest_along(const std::vector<float>& values, int step, int count, int lines) const {
    const int line_step = step == 1 ? width_ : 1;
    std::vector<float> greatest(values.size(), 0);
    for (int line = 0; line < lines; ++line) {
      for (int k = 0; k < count; ++k) {
        float& best = greatest[static_cast<std::size_t>(line * line_step + k * step)];
        for (int n = std::max(0, k - kAround_px); n <= std::min(count - 1, k + kAround_px); ++n)
          best = std::max(best, values[static_cast<std::size_t>(line * line_step + n * step)]);
      }
    }
    return greatest;
  }

  int width_, height_;
  std::vector<float> x_, y_;
};

constexpr int kSide = 2 * kReach_px / kStep_px + 1;
constexpr double kConvincing = 0.5;  // an outline that lies on edges so well lies on its own

/// The edges under an outline, per shift of it.
struct EdgeSums {
  std::vector<double> edges = std::vector<double>(kSide * kSide, 0);
  std::vector<double> points = std::vector<double>(kSide * kSide, 0);

  static int shift_of(int cell) { return cell * kStep_px - kReach_px; }
  static std::size_t cell_of(int row, int column) { return static_cast<std::size_t>(row * kSide + column); }
  double share(std::size_t cell) const { return points[cell] > 0 ? edges[cell] / points[cell] : 0; }
  double share_here() const { return share(cell_of(kSide / 2, kSide / 2)); }
  void merge(const EdgeSums& other) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      edges[i] += other.edges[i];
      points[i] += other.points[i];
    }
  }
};

enum class Search { everywhere, mirrored, here };

EdgeSums edges_under(const EdgeImage& image, const std::vector<OutlinePoint>& outline, Search how) {
  EdgeSums sums;
  const bool mirrored = how == Search::mirrored;
  const int first = how == Search::here ? kSide / 2 : 0, last = how == Search::here ? first : kSide - 1;
  for (int row = first; row <= last; ++row) {
    for (int column = first; column <= last; ++column) {
      const std::size_t cell = EdgeSums::cell_of(row, column);
      for (const OutlinePoint& p : outline) {
        const int x = (mirrored ? image.mirrored_x(p.x) : p.x) + EdgeSums::shift_of(column);
        const float edge =
            image.near(x, p.y + EdgeSums::shift_of(row), mirrored ? -p.normal_x : p.normal_x, p.normal_y);
        if (edge < 0) continue;
        sums.edges[cell] += edge;
        sums.points[cell] += 1;
      }
    }
  }
  return sums;
}

/// Images and outlines of the views that have both.
struct Outlines {
  std::vector<EdgeImage> images;
  std::vector<std::vector<OutlinePoint>> outlines;

  /// Outline k on image k + `offset`, where there is one.
  EdgeSums total(Search how, int offset = 0) const {
    std::vector<EdgeSums> of_view(images.size());
    tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t v) {
      const auto other = static_cast<std::ptrdiff_t>(v) + offset;
      if (other < 0 || other >= static_cast<std::ptrdiff_t>(images.size())) return;
      of_view[v] = edges_under(images[static_cast<std::size_t>(other)], outlines[v], how);
    });
    EdgeSums sum;
    for (const EdgeSums& s : of_view) sum.merge(s);
    return sum;
  }
};

Outlines outlines_of(std::span<const RegistrationView> views, std::span<const VirtualMeasurement> predictions,
                     const CameraModel& camera) {
  Outlines all;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].image.empty()) continue;
    auto outline = outline_of(views[v], predictions[v], camera);
    if (outline.empty()) continue;
    all.images.emplace_back(views[v], camera);
    all.outlines.push_back(std::move(outline));
  }
  return all;
}

void find_best_shift(const EdgeSums& sums, ImageRegistration& result) {
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const int dx = EdgeSums::shift_of(column), dy = EdgeSums::shift_of(row);
      const double share = sums.share(EdgeSums::cell_of(row, column));
      if (std::max(std::abs(dx), std::abs(dy)) < kSame_px || share <= result.elsewhere) continue;
      result.elsewhere = share;
      result.shift_x_px = dx;
      result.shift_y_px = dy;
    }
  }
}

}  // namespace

ImageRegistration look_at_images(std::span<const RegistrationView> views,
                                 std::span<const VirtualMeasurement> predictions, const CameraModel& camera) {
  const Outlines all = outlines_of(views, predictions, camera);
  ImageRegistration result;
  for (const auto& outline : all.outlines) result.outline_points += outline.size();
  if (result.outline_points == 0) return result;
  const EdgeSums everywhere = all.total(Search::everywhere);
  result.here = everywhere.share_here();
  find_best_shift(everywhere, result);
  if (result.here >= kConvincing && result.here > result.elsewhere) return result;
  const EdgeSums mirrored = all.total(Search::mirrored);
  for (std::size_t cell = 0; cell < mirrored.edges.size(); ++cell)
    result.mirrored = std::max(result.mirrored, mirrored.share(cell));
  result.other_view =
      std::max(all.total(Search::here, 1).share_here(), all.total(Search::here, -1).share_here());
  return result;
}

}  // namespace calibrd
