// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "core/virtual_cell/link_scenes.hpp"

namespace calibrd {

/// The point of a link's surface nearest to `point_link` (link frame, m), on the triangles themselves;
/// nothing when it is not closer than `within_m`. `mesh`: what the scene was built from.
std::optional<Eigen::Vector3f> nearest_on_link(const LinkScenes::Surface& surface, const TriangleMesh& mesh,
                                               const Eigen::Vector3f& point_link, float within_m);

}  // namespace calibrd
