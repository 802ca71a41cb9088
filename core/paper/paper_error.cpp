// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/paper_error.hpp"

namespace calibrd {
namespace {

class PaperErrorCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "paper"; }
  std::string message(int value) const override {
    switch (static_cast<PaperError>(value)) {
      case PaperError::robot_not_found:
        return "no measured points in the region of interest; is the guess right, or the region too small?";
      case PaperError::pcl_missing:
        return "the paper's method needs this shared object, and PCL's libraries that it is linked to; "
               "install or build it beside the programs, or use the method full";
      case PaperError::pcl_failed:
        return "PCL's ICP found too few correspondences; give a better guess";
      case PaperError::bad_region:
        return "a region of interest is six numbers between commas, x0,y0,z0,x1,y1,z1 in the sensor frame "
               "(m), the first three smaller than the last three";
      case PaperError::other_method:
        return "this belongs to the paper's method; give --method paper as well, or leave it out";
    }
    return "unknown error";
  }
};

}  // namespace

const std::error_category& paper_error_category() {
  static const PaperErrorCategory category;
  return category;
}

std::string paper_error_name(const Error& error) {
  switch (static_cast<PaperError>(error.code.value())) {
    case PaperError::robot_not_found:
      return "robot_not_found";
    case PaperError::pcl_missing:
      return "pcl_missing";
    case PaperError::pcl_failed:
      return "icp_failed";
    case PaperError::bad_region:
      return "bad_region";
    case PaperError::other_method:
      return "other_method";
  }
  return "unknown";
}

}  // namespace calibrd
