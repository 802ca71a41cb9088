// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What DriftWatch makes of the background while it watches.
#include <algorithm>

#include "core/drift/drift_watch.hpp"

namespace calibrd {
namespace {

constexpr double kRefine_s = 3;  // after learning, until the map's noise is small against a frame's
constexpr double kAbsorbEvery_s = 5;
constexpr double kDenied_s = 2;  // what has moved as one, and stands for so long, is background
constexpr double kStillDenied_s = 1;
constexpr float kLeastMeanFrames = 20;

}  // namespace

/// What the robot carries moves with the end of its arm.
void DriftWatch::mark_carried() {
  carried_.assign(map_.cells().size(), 0);
  const Pose T_sensor_base = T_base_sensor_.inverse();
  std::vector<Eigen::Vector3d> tips_sensor;
  for (const std::size_t link : tips_)
    tips_sensor.push_back(T_sensor_base * robot_.cell().link_poses()[link].translation());
  const double reach = settings_.carried_reach_m * settings_.carried_reach_m;
  for (std::size_t i = 0; i < carried_.size(); ++i) {
    if (matcher_.states()[i] != CellState::nearer) continue;
    const auto width = static_cast<std::size_t>(map_.grid().width);
    const Eigen::Vector3d p = static_cast<double>(matcher_.depth_m()[i]) *
                              map_.rays().at(static_cast<int>(i % width), static_cast<int>(i / width));
    for (const auto& tip : tips_sensor)
      if ((p - tip).squaredNorm() < reach) carried_[i] = 1;
  }
}

/// The first frames make the map better than the few views it was learnt from, as long as nothing moves; one
/// in which a single thing has slid may be of a sensor that has.
void DriftWatch::refine(const BackgroundObservation& observation, double now_s) {
  if (is_refined_) return;
  if (now_s - learnt_s_ > kRefine_s) {
    is_refined_ = true;
    map_.fit_planes();
    return matcher_.refresh();
  }
  if (!observation.has_evidence || observation.realigned || observation.unsupported) return;
  if (is_doubtful() || dispute_.is_open() || moved_) return;
  std::vector<std::uint8_t> chosen(matcher_.states().size());
  std::ranges::transform(matcher_.states(), chosen.begin(),
                         [](CellState state) -> std::uint8_t { return state == CellState::same ? 1 : 0; });
  auto depth_m = matcher_.depth_m();
  for (float& z : depth_m)
    if (z > 0) z -= static_cast<float>(observation.known_offset_m());
  map_.refine(depth_m, chosen);
}

/// What stands for long is background; the plain one is left as it was, or a sensor that creeps would take it
/// along. Not while nothing says that the sensor stands: what it sees from elsewhere is no background.
void DriftWatch::absorb(double now_s) {
  if (now_s - absorbed_s_ < kAbsorbEvery_s) return;
  absorbed_s_ = now_s;
  if (moved_ || is_doubtful() || is_unsettled() || !is_known_to_stand()) return;
  take(scene_.unchanged_for(settings_.absorb_s));
  absorb_what_was_pushed(now_s);
}

/// A box that was pushed so little that its cells still look the same disputes where the sensor is. The robot
/// has said since the dispute began that the sensor has not slid: so it is the box.
void DriftWatch::absorb_what_was_pushed(double now_s) {
  if (!dispute_.is_open_for(settings_.absorb_s, now_s)) return;
  if (!dispute_.is_denied() || !robot_word_.agrees_since(dispute_.since_s(), now_s)) return;
  std::vector<std::uint8_t> chosen(matcher_.states().size());
  const int width = map_.grid().width;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
    const bool is_seen = matcher_.states()[i] == CellState::same;
    chosen[i] =
        is_seen && dispute_.window().holds(x, y) && scene_.mean_frames()[i] >= kLeastMeanFrames ? 1 : 0;
  }
  if (!take(chosen)) return;
  followed_ += dispute_.turn_shift();
  dispute_.settle(now_s);
}

/// A table with all that stands on it: what the robot denied to be the sensor's move is the background now.
void DriftWatch::absorb_what_moved_as_one(double now_s) {
  if (moved_ || now_s - denied_s_ > kStillDenied_s || now_s - denied_since_s_ < kDenied_s) return;
  std::vector<std::uint8_t> chosen(matcher_.states().size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const CellState state = matcher_.states()[i];  // silhouettes have moved, too
    const bool seen = state == CellState::same || state == CellState::nearer || state == CellState::farther;
    chosen[i] = seen && scene_.mean_frames()[i] >= kLeastMeanFrames ? 1 : 0;
  }
  take(chosen);
  test_.reset();
  denied_since_s_ = now_s;
}

/// False: there was nothing to take.
bool DriftWatch::take(const std::vector<std::uint8_t>& chosen) {
  if (std::ranges::count(chosen, std::uint8_t{1}) == 0) return false;
  auto depth_m = scene_.mean_depth_m();  // less what the range reads otherwise than when the rest was learnt
  for (float& z : depth_m) z -= static_cast<float>(offset_m_);
  map_.relearn(depth_m, scene_.mean_frames(), chosen);
  matcher_.refresh();
  return true;
}

}  // namespace calibrd
