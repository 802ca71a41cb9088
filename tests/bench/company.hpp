// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/sim/world/cell.hpp"
#include "drivers/sim/world/random.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::bench {

/// What moves in a simulated cell beside its robot: several people, a part in the robot's gripper. They are
/// drawn as links that hang on the robot's base, of which the estimator's model of the robot knows nothing.
class Company {
 public:
  static constexpr std::size_t kPeople = 3;

  /// Adds its bodies to `cell`, which must outlive it and hold still. Nobody is there at first.
  Company(sim::Cell& cell, sim::Random& random);

  /// `person` < kPeople walks to and fro, or stands where `from_m` is when its speed is 0.
  void send(std::size_t person, const sim::PersonState& walk) { people_[person] = walk; }
  void send_all_away() { people_.assign(kPeople, {}); }
  /// Takes a part of that size (m) into the gripper, or puts it down.
  void carry(const std::optional<Eigen::Vector3d>& size_m);
  /// Where everything is at that moment. `joints`: true ones.
  void move(const sim::Joints& joints, std::int64_t now_ns);

 private:
  std::size_t add(sim::Mesh mesh, float albedo);
  void place(std::size_t link, const Eigen::Isometry3d& T_base_body);

  sim::Cell& cell_;
  std::size_t flange_, first_person_, part_;
  Eigen::Vector3d grip_;  // flange frame: where the middle of a part is, in lengths of the part
  bool carries_ = false;
  std::vector<sim::PersonState> people_;
};

}  // namespace calibrd::bench
