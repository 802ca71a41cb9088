// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/sim_error.hpp"

#include <string>

namespace calibrd::sim {
namespace {

const char* text(SimError error) {
  switch (error) {
    case SimError::urdf_unreadable:
      return "the robot description cannot be read; give a URDF file with --urdf";
    case SimError::mesh_not_found:
      return "the mesh file is in none of the model folders; name the folder that holds the package with "
             "--models";
    case SimError::mesh_unreadable:
      return "the mesh cannot be read; give a binary STL or a Collada file with triangles";
    case SimError::no_joints:
      return "the robot has no moving joint; give the URDF of an arm";
    case SimError::too_large:
      return "more than the simulator holds; take some away";
    case SimError::description_unreadable:
      return "the world description cannot be read; give a JSON file with --world";
    case SimError::description_invalid:
      return "the world description is wrong here; correct it as docs/simulator.md shows";
    case SimError::no_free_posture:
      return "found no posture clear of the cell; move the objects away from the robot";
    case SimError::world_unwritable:
      return "the shared world file cannot be written; name a writable place with --world-file";
    case SimError::world_in_use:
      return "another simulator runs with this world file; end it, or name another file with --world-file";
    case SimError::world_unreadable:
      return "there is no running simulator behind this world file; start calibrd-sim and set "
             "CALIBRD_SIM_WORLD";
    case SimError::world_mismatch:
      return "the world file was written by another build; use calibrd-sim and the driver of one build";
    case SimError::cannot_listen:
      return "cannot listen on this port; free it, or take any free port with 0";
    case SimError::request_invalid:
      return "the request is wrong here; correct it as docs/simulator.md shows";
    case SimError::not_found:
      return "there is nothing of that name; GET /truth lists what there is";
    case SimError::method_not_allowed:
      return "this call takes another method; docs/simulator.md lists all calls";
    case SimError::capture_unwritable:
      return "the capture cannot be written; name an absent or empty folder on a disk with room";
    case SimError::no_view_of_robot:
      return "no pose of the sensor shows enough of the robot; lower --min-robot-pixels or --distance";
  }
  return "unknown error of the simulator";
}

class SimErrorCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "calibrd.sim"; }
  std::string message(int value) const override { return text(static_cast<SimError>(value)); }
};

}  // namespace

std::error_code make_error_code(SimError error) {
  static const SimErrorCategory category;
  return {static_cast<int>(error), category};
}

}  // namespace calibrd::sim
