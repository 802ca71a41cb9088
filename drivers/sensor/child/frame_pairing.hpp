// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "drivers/sensor/child/frame_numbering.hpp"

namespace calibrd {

/// Distance of two moments in device time; nothing when they cannot be the same one. Timestamps decide; where
/// a driver sets none, the index does (streams that started apart do not count alike, so the index comes
/// second).
inline std::optional<std::uint64_t> apart_us(const Moment& a, const Moment& b, std::uint64_t tolerance_us) {
  if (a.timestamp_us == 0 || b.timestamp_us == 0)
    return a.index == b.index ? std::optional<std::uint64_t>(0) : std::nullopt;
  const std::uint64_t apart =
      a.timestamp_us > b.timestamp_us ? a.timestamp_us - b.timestamp_us : b.timestamp_us - a.timestamp_us;
  return apart <= tolerance_us ? std::optional(apart) : std::nullopt;
}

/// Brings depth frames and images of the same moment together, within half a period. A depth frame whose
/// partner does not come is let go alone: when its partner can no longer come, or one period after its
/// reception.
template <class Depth, class Image>
class FramePairing {
 public:
  using Clock = std::chrono::steady_clock;
  struct Pair {
    Depth depth;
    std::optional<Image> image;
  };

  FramePairing(bool with_image, std::chrono::microseconds period)
      : with_image_(with_image), period_(period) {}

  void add_depth(Depth depth, const Moment& moment, Clock::time_point received) {
    depths_.push_back({std::move(depth), moment, received});
  }
  void add_image(Image image, const Moment& moment) {
    images_.push_back({std::move(image), moment});
    if (images_.size() > kMostImages) images_.pop_front();
  }

  /// The next frame that waits for nothing more, in the order of the depth frames.
  std::optional<Pair> next(Clock::time_point now) {
    if (depths_.empty()) return std::nullopt;
    const WaitingDepth& front = depths_.front();
    const std::size_t partner = find_partner(front.moment);
    if (partner == images_.size() && is_worth_waiting(front, now)) return std::nullopt;
    Pair pair{std::move(depths_.front().depth), std::nullopt};
    if (partner < images_.size()) {
      pair.image = std::move(images_[partner].image);
      images_.erase(images_.begin(), images_.begin() + static_cast<std::ptrdiff_t>(partner) + 1);
    }
    depths_.pop_front();
    return pair;
  }

  /// When the waiting depth frame is let go alone.
  std::optional<Clock::time_point> deadline() const {
    if (depths_.empty()) return std::nullopt;
    return depths_.front().received + period_;
  }

 private:
  static constexpr std::size_t kMostImages = 4;
  struct WaitingDepth {
    Depth depth;
    Moment moment;
    Clock::time_point received;
  };
  struct WaitingImage {
    Image image;
    Moment moment;
  };

  std::uint64_t tolerance_us() const { return static_cast<std::uint64_t>(period_.count()) / 2; }

  std::size_t find_partner(const Moment& moment) const {
    std::size_t best = images_.size();
    std::uint64_t least = 0;
    for (std::size_t i = 0; i < images_.size(); ++i) {
      const auto apart = apart_us(moment, images_[i].moment, tolerance_us());
      if (!apart || (best < images_.size() && *apart >= least)) continue;
      best = i;
      least = *apart;
    }
    return best;
  }

  bool is_worth_waiting(const WaitingDepth& front, Clock::time_point now) const {
    if (!with_image_ || depths_.size() > 1 || now >= front.received + period_) return false;
    const std::uint64_t latest = images_.empty() ? 0 : images_.back().moment.timestamp_us;
    return front.moment.timestamp_us == 0 || latest <= front.moment.timestamp_us;
  }

  bool with_image_;
  std::chrono::microseconds period_;
  std::deque<WaitingDepth> depths_;
  std::deque<WaitingImage> images_;
};

}  // namespace calibrd
