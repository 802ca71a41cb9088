// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <boost/json/object.hpp>
#include <string>

/// Reads poses as the makers of the formats define them, from turns about single axes: nothing of what writes
/// them is used.
namespace calibrd::test {

/// The pose that the members of a payload give, as it maps points: p_to = T * p_from, m. Throws where a
/// member lacks, or for a format that is not known.
Eigen::Isometry3d read_members(const std::string& format, const boost::json::object& payload);

/// The pose that its text gives (member "text"). Throws as read_members().
Eigen::Isometry3d read_text(const std::string& format, const boost::json::object& payload);

/// Every number in a text that is not part of a word.
std::vector<double> numbers_in(const std::string& text);

}  // namespace calibrd::test
