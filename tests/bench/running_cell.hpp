// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/company.hpp"
#include "tests/bench/scene.hpp"

namespace calibrd::bench {

/// What can be staged before a watched sensor.
enum class Event {
  nothing,
  sensor_moved,
  something_in_front,
  scene_changed,
  robot_model_wrong,
  depth_bias_changed,
  dark
};
inline constexpr Event kEvents[] = {Event::nothing,       Event::sensor_moved,      Event::something_in_front,
                                    Event::scene_changed, Event::robot_model_wrong, Event::depth_bias_changed,
                                    Event::dark};
/// The verdict that is right for it, by name.
const char* right_verdict(Event event);

/// A scene whose robot works and in which things happen, frame by frame at 30 Hz, in memory.
class RunningCell {
 public:
  static constexpr double kRate_hz = 30;

  /// `scene` must outlive it. The robot visits the postures of the scene's truth, more than there are views
  /// of, holding still for a second at each.
  RunningCell(const Scene& scene, std::shared_ptr<const sim::SensorTables> tables, std::uint64_t seed);

  struct Frame {
    View view;  ///< joints as reported, of the frame's moment
    bool still = false;
  };
  Frame next();
  /// Lets time pass unseen.
  void skip(double seconds) { now_ns_ += static_cast<std::int64_t>(1e9 * seconds); }
  double time_s() const { return 1e-9 * static_cast<double>(now_ns_); }

  /// Moves the sensor, turned about its own place, in random directions ...
  void move_sensor(double shift_m, double turn_rad);
  /// ... or to a place.
  void put_sensor(const Pose& T_base_sensor) { T_base_sensor_ = T_base_sensor; }
  Eigen::Vector3d random_direction();
  /// Something of that kind, of random size and place. Says what it did. Moves are of 3 mm or 3 mrad and
  /// more.
  std::string stage(Event event);

  sim::WorldState& state() { return state_; }
  sim::Random& random() { return random_; }
  const Pose& T_base_sensor() const { return T_base_sensor_; }
  /// How far the sensor has come from where it was at first.
  double moved_m() const;
  double turned_rad() const;
  /// One to three people walk to and fro across the space between the sensor and the robot.
  void send_people();
  void send_people_away() {
    state_.person.present = 0;
    company_.send_all_away();
  }
  Company& company() { return company_; }
  /// Somebody walks across between sensor and robot, `part` of the way from the sensor.
  sim::PersonState walk_across(double part);
  /// Takes away, brings back or shifts one of the things that stand around, so that the sensor sees it.
  /// Empty: none of them can be seen.
  std::string change_scene();

 private:
  std::string change_object(std::size_t chosen);
  std::vector<float> true_depth_m();

  const Scene& scene_;
  sim::WorldState state_;
  sim::Random random_;
  sim::Cell cell_;
  Company company_;
  sim::SensorModel model_;
  Pose T_base_sensor_;
  std::uint64_t frame_ = 0, seed_;
  std::int64_t now_ns_ = 0;
  std::vector<std::size_t> order_;  // of the model's joints in the simulator's
  std::vector<std::uint16_t> depth_mm_;
  double bias_from_m_ = 0, bias_to_m_ = 0, bias_since_s_ = -1;
};

}  // namespace calibrd::bench
