// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "core/geometry/camera_model.hpp"
#include "core/robot/joint_mapping.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd {

/// What a pose was found with, of the robot: the URDF's text and the surfaces it brought in (as
/// fingerprints), base link and joint mapping. Lines of "name: value".
std::string robot_basis(const std::filesystem::path& urdf, const RobotModel& model,
                        const JointMapping& mapping);

/// The same of the sensor: its intrinsics, and whether its rows are flipped.
std::string camera_basis(const CameraModel& camera, bool mirror);

/// Which lines differ: "intrinsics (were …, are …)"; empty: none.
std::string basis_changes(const std::string& before, const std::string& now);

}  // namespace calibrd
