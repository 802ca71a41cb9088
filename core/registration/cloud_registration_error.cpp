// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/cloud_registration_error.hpp"

namespace calibrd {
namespace {

class CloudRegistrationErrorCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "cloud registration"; }
  std::string message(int value) const override {
    switch (static_cast<CloudRegistrationError>(value)) {
      case CloudRegistrationError::too_few_points:
        return "too few usable points to register; give clouds that show more of the surface";
      case CloudRegistrationError::no_overlap:
        return "the clouds do not lie on each other; start closer, or raise the largest distance of a pair";
      case CloudRegistrationError::unobservable:
        return "the clouds could slide or turn on each other without a trace, as planes, cylinders and "
               "spheres do; show more of the scene";
    }
    return "unknown cloud registration error";
  }
};

}  // namespace

const std::error_category& cloud_registration_error_category() {
  static const CloudRegistrationErrorCategory category;
  return category;
}

}  // namespace calibrd
