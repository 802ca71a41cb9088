// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/robot/joint_mapping.hpp"
#include "core/robot/nearest_name.hpp"

namespace calibrd {
namespace {

bool numbers_usable(const JointMappingEntry& entry) {
  const auto finite = [](const AxisCoupling& coupling) { return std::isfinite(coupling.factor); };
  return std::abs(entry.sign) == 1 && std::isfinite(entry.scale) && entry.scale > 0 &&
         std::isfinite(entry.offset_rad) && std::ranges::all_of(entry.coupling, finite);
}

Error at_joint(JointMappingError code, const std::string& joint, const std::string& what = {}) {
  return {code, "joint '" + joint + "'" + (what.empty() ? "" : ", " + what)};
}

}  // namespace

class JointMappingBuilder {
 public:
  JointMappingBuilder(const JointMappingConfig& config, std::span<const std::string> model_joints)
      : config_(config), model_joints_(model_joints) {}

  Result<JointMapping> build() {
    mapping_.rows_.resize(model_joints_.size());
    for (const auto& entry : config_.joints)
      if (auto status = add(entry); !status) return status.error();
    for (std::size_t joint = 0; joint < model_joints_.size(); ++joint)
      if (mapping_.rows_[joint].terms.empty())
        return at_joint(JointMappingError::missing_joint, model_joints_[joint]);
    if (auto status = check_axes_differ(); !status) return status.error();
    return std::move(mapping_);
  }

 private:
  Status add(const JointMappingEntry& entry) {
    const auto joint = std::ranges::find(model_joints_, entry.joint);
    if (joint == model_joints_.end())
      return at_joint(JointMappingError::unknown_joint, entry.joint, name_hint(entry.joint, model_joints_));
    auto& row = mapping_.rows_[static_cast<std::size_t>(joint - model_joints_.begin())];
    if (!row.terms.empty()) return at_joint(JointMappingError::joint_twice, entry.joint);
    if (!numbers_usable(entry)) return at_joint(JointMappingError::bad_number, entry.joint);
    row.offset = entry.offset_rad;
    const double factor = entry.sign * entry.scale;
    if (auto status = add_term(row, entry, entry.axis, factor); !status) return status;
    for (const auto& coupling : entry.coupling)
      if (auto status = add_term(row, entry, coupling.axis, factor * coupling.factor); !status) return status;
    return Done{};
  }

  Status add_term(JointMapping::Row& row, const JointMappingEntry& entry, const ControllerAxis& axis,
                  double factor) {
    const auto index = index_of(axis, entry.joint);
    if (!index) return index.error();
    row.terms.push_back({*index, factor});
    mapping_.values_read_ = std::max(mapping_.values_read_, *index + 1);
    return Done{};
  }

  Result<std::size_t> index_of(const ControllerAxis& axis, const std::string& joint) const {
    int index = 0;
    if (const auto* name = std::get_if<std::string>(&axis)) {
      const auto found = std::ranges::find(config_.axis_names, *name);
      if (found == config_.axis_names.end())
        return at_joint(JointMappingError::unknown_axis, joint,
                        "axis '" + *name + "', " + name_hint(*name, config_.axis_names));
      index = static_cast<int>(found - config_.axis_names.begin());
    } else {
      index = std::get<int>(axis);
    }
    if (index < 0 || index >= config_.axis_count)
      return at_joint(JointMappingError::axis_out_of_range, joint,
                      "axis " + std::to_string(index) + " of " + std::to_string(config_.axis_count));
    return static_cast<std::size_t>(index);
  }

  Status check_axes_differ() const {
    const auto axes = mapping_.axes();
    for (std::size_t joint = 0; joint < axes.size(); ++joint) {
      const auto earlier =
          std::find(axes.begin(), axes.begin() + static_cast<std::ptrdiff_t>(joint), axes[joint]);
      const auto other = static_cast<std::size_t>(earlier - axes.begin());
      if (other != joint)
        return Error{JointMappingError::axis_twice, "joints '" + model_joints_[other] + "' and '" +
                                                        model_joints_[joint] + "', axis " +
                                                        std::to_string(axes[joint])};
    }
    return Done{};
  }

  const JointMappingConfig& config_;
  std::span<const std::string> model_joints_;
  JointMapping mapping_;
};

Result<JointMapping> JointMapping::make(const JointMappingConfig& config,
                                        std::span<const std::string> model_joints) {
  return JointMappingBuilder(config, model_joints).build();
}

}  // namespace calibrd
