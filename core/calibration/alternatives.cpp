// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/alternatives.hpp"

#include <algorithm>

namespace calibrd {
namespace {

using Joints = std::vector<double>;
using AllJoints = std::vector<Joints>;

void add_mirror(std::vector<Alternative>& all) {
  Alternative mirrored;
  mirrored.reason = {
      "depth_mirrored",
      "the views fit when the depth image is mirrored left to right: the sensor delivers mirrored "
      "images; set sensors.ID.mirror = true, or turn the driver's mirroring off"};
  mirrored.of_sensor = true;
  mirrored.mirrored = true;
  all.push_back(std::move(mirrored));
}

void add_intrinsics(std::vector<Alternative>& all) {
  Alternative swapped;
  swapped.reason = {"intrinsics_swapped",
                    "the views fit when fx and fy, cx and cy change places: correct the sensor's intrinsics"};
  swapped.of_sensor = true;
  swapped.camera = [](CameraModel camera) {
    std::swap(camera.fx, camera.fy);
    std::swap(camera.cx, camera.cy);
    return camera;
  };
  all.push_back(swapped);
  swapped.reason.text = "the views fit when cx and cy change places: correct the sensor's intrinsics";
  swapped.camera = [](CameraModel camera) {
    std::swap(camera.cx, camera.cy);
    return camera;
  };
  all.push_back(std::move(swapped));
}

void add_shifts(std::vector<Alternative>& all) {
  for (const int offset : {1, -1}) {
    Alternative shifted;
    shifted.reason = {
        "joints_not_of_frame",
        std::string("the views fit when each takes the joints of the ") + (offset > 0 ? "next" : "previous") +
            " one: frames and joints are of different moments; check the stamps and the latency"};
    shifted.joints = [offset](const AllJoints& joints, std::size_t view) {
      const auto other = static_cast<std::ptrdiff_t>(view) + offset;
      if (other < 0 || other >= static_cast<std::ptrdiff_t>(joints.size())) return Joints{};
      return joints[static_cast<std::size_t>(other)];
    };
    all.push_back(std::move(shifted));
  }
}

/// `order`: for each joint of the model, the place of its value among those that came.
Alternative reordered(const std::vector<std::string>& names, const std::vector<std::size_t>& order) {
  std::string list;
  for (const std::size_t place : order) list += (list.empty() ? "" : ", ") + names[place];
  Alternative alternative;
  alternative.reason = {
      "joint_order_wrong",
      "the views fit when the joints are taken in another order: the model's joints, in their "
      "order, want the values given for " +
          list + "; correct the joint names or robot.joints.NAME.axis"};
  alternative.joints = [order](const AllJoints& joints, std::size_t view) {
    Joints sorted;
    for (const std::size_t place : order) sorted.push_back(joints[view][place]);
    return sorted;
  };
  return alternative;
}

/// One joint taken out of the row and put in elsewhere: neighbours swapped, tails turned round. An elbow that
/// is counted last (S L U R B T E) is among them.
void add_orders(const std::vector<std::string>& names, std::vector<Alternative>& all) {
  std::vector<std::vector<std::size_t>> seen;
  std::vector<std::size_t> straight(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) straight[i] = i;
  const auto add = [&](std::size_t from, std::size_t to) {
    std::vector<std::size_t> order = straight;
    order.erase(order.begin() + static_cast<std::ptrdiff_t>(from));
    order.insert(order.begin() + static_cast<std::ptrdiff_t>(to), from);
    if (std::ranges::find(seen, order) != seen.end()) return;
    seen.push_back(order);
    all.push_back(reordered(names, order));
  };
  for (std::size_t i = 0; i + 1 < names.size(); ++i) {
    add(names.size() - 1, i);
    add(i, names.size() - 1);
  }
  for (std::size_t i = 0; i + 1 < names.size(); ++i) add(i, i + 1);
}

void add_signs(const std::vector<std::string>& names, std::vector<Alternative>& all) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    Alternative turned;
    turned.reason = {"joint_sign_wrong", "the views fit when " + names[i] +
                                             " turns the other way: correct its sign (robot.joints." +
                                             names[i] + ".sign)"};
    turned.joints = [i](const AllJoints& joints, std::size_t view) {
      Joints positions = joints[view];
      positions[i] = -positions[i];
      return positions;
    };
    all.push_back(std::move(turned));
  }
}

}  // namespace

std::vector<Alternative> alternatives(const std::vector<std::string>& joint_names) {
  std::vector<Alternative> all;
  add_intrinsics(all);
  add_mirror(all);
  add_shifts(all);
  add_orders(joint_names, all);
  add_signs(joint_names, all);
  return all;
}

}  // namespace calibrd
