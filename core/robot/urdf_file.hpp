// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>

#include "core/base/result.hpp"

namespace urdf {
class ModelInterface;
}

namespace calibrd {

/// The URDF as urdfdom reads it. What urdfdom would print becomes the error's detail.
/// Errors: RobotModelError::urdf_not_found, urdf_invalid. Safe to call from any thread (calls wait for each
/// other).
Result<std::shared_ptr<const urdf::ModelInterface>> read_urdf(const std::filesystem::path& file);

}  // namespace calibrd
