// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "api/service/reports.hpp"
#include "core/drift/drift_watch.hpp"
#include "server/live_cell/resting_place.hpp"

namespace calibrd {

/// The drift watch of one live sensor: gives it its background, keeps what it said. Frames and checks come
/// from the sensor's thread; the rest is safe to call from any.
class DriftMonitor {
 public:
  explicit DriftMonitor(std::unique_ptr<DriftWatch> watch)
      : watch_(std::move(watch)), fresh_(watch_->report()), newest_(fresh_) {}

  /// Another pose, from the next frame on. `background`: as the sensor saw it when the pose was found;
  /// nullptr: it is learnt from frames that pass a check.
  void set_pose(const Pose& T_base_sensor, std::shared_ptr<const BackgroundMap> background);

  /// The next frame; joint_positions_rad empty where they are not known.
  void add_frame(const View& frame);
  /// What a comparison of `frame` with the robot said.
  void add_check(const View& frame, const PoseCheck& check);

  /// The watch speaks of the pose that was set last.
  DriftVerdict verdict() const;
  /// The background is known, in view, and where it was.
  bool is_in_place() const;
  /// As DriftWatch::is_out_of_sight(), of the last frame.
  bool is_out_of_sight() const;
  /// As DriftWatch::is_contested(), of the last frame or check.
  bool is_contested() const;
  /// As DriftWatch::is_unsettled().
  bool is_unsettled() const;
  bool wants_check() const;
  /// Enough frames were seen since the pose was set, the sensor was back, or the lens dark, for a moved
  /// sensor to show; also while no background is known that could tell. Before, a check against the robot
  /// proves too little.
  bool has_looked() const;
  /// The sensor was away and may have been moved. On the sensor's thread.
  void on_sensor_lost();
  /// How much more the range reads than when the background was learnt, m.
  double depth_offset_change_m() const;
  /// Where a sensor that has moved is now, as far as the background tells.
  std::optional<RestingPlace::Sight> sensor_seen() const;
  /// The background as it was learnt for the pose that was set last; nothing while it is not known. What has
  /// come since and stands for long is not in it.
  std::shared_ptr<const BackgroundMap> background() const;

  api::DriftReport report() const;

 private:
  struct Order {
    Pose T_base_sensor;
    std::shared_ptr<const BackgroundMap> background;
  };
  void take_order();
  void keep_for_background(const View& frame);
  void count_frame();
  void note(const DriftReport& report, double now_s);

  const std::unique_ptr<DriftWatch> watch_;  // the sensor's thread's own
  const DriftReport fresh_;                  // of a watch that has seen nothing yet
  std::vector<View> passed_;                 // frames to learn the background from; the thread's own

  mutable std::mutex mutex_;  // guards what follows
  std::optional<Order> order_;
  bool has_pose_ = false;
  DriftReport newest_;
  std::shared_ptr<const BackgroundMap> background_;
  bool in_place_ = false, wants_check_ = false, out_of_sight_ = false, contested_ = false, unsettled_ = false;
  int quarters_seen_ = 0;  // of frames, since the pose was set, or the sensor lost
  int frames_dark_ = 0;    // on end
  Clock::time_point stamp_;
  std::deque<api::DriftSample> series_;  // one for each second, the largest statistic of it
  std::deque<api::DriftEvent> events_;
};

}  // namespace calibrd
