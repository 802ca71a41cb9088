// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/timing/frame_motion.hpp"
#include "core/timing/offset_filter.hpp"
#include "core/timing/offset_search.hpp"

namespace calibrd {

struct TimeOffsetSettings {
  FrameMotionSettings frame;
  OffsetFilterSettings filter;
  OffsetSearchSettings search;
};

/// How much later than joints frames are stamped: dt = what is wrong with the frames' stamps (later than the
/// exposure) less what is wrong with the joints'. The joints of a frame are those of its stamp less dt.
struct TimeOffset {
  double value_s = 0;
  double sigma_s = 0;
  double jitter_s = 0;  ///< of single frames, beyond what their noise explains
  std::size_t blocks = 0;
};

/// Estimates the time offset between a sensor and the robot's joints, from frames in which the robot moves
/// and a calibrated pose: the depth that the joints of `stamp - dt` predict against the measured one, r ≈
/// (∂z/∂q · q̇) dt per pixel of the robot. Frames are cheap (every fourth pixel; one rendering each once the
/// offset is roughly known) and need not be many. One thread at a time.
class TimeOffsetEstimator {
 public:
  /// Shares the surfaces of `cell`, whose robot must outlive it.
  TimeOffsetEstimator(const VirtualCell& cell, const CameraModel& camera,
                      const TimeOffsetSettings& settings = {});

  /// Forgets everything: when a link was made anew, stamps may be late by another time.
  void reset();
  /// Frames are compared with another pose from now on: the offset alone is kept.
  void forget_pose() { filter_.forget_pose(); }

  /// Takes a frame in which the robot moves. False: it said nothing (joints not known around it, too few
  /// pixels).
  bool add(const TimedFrame& frame, const JointsAt& joints_at);

  /// How long before and after a frame's stamp joints are asked for at most.
  Clock::duration joints_before() const;
  Clock::duration joints_after() const;

  /// Nothing while too few frames have said something.
  std::optional<TimeOffset> estimate() const;

 private:
  bool search(const TimedFrame& frame, const JointsAt& joints_at);

  TimeOffsetSettings settings_;
  FrameMotion motion_;
  OffsetSearch search_;
  OffsetFilter filter_;
  std::optional<double> rough_s_;  // nothing while it is searched for
};

}  // namespace calibrd
