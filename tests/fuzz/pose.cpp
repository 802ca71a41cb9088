// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What a user types in: a pose (a JSON file, or seven numbers), a table's height. Input: which of
// them, then the text.
#include "core/capture/pose_json.hpp"
#include "core/planning/table_height.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace calibrd;

void check(const Result<Pose>& pose) {
  if (!pose) return fuzz::require(!pose.error().message().empty(), "an error says something");
  const Eigen::Matrix3d R = pose->linear();
  fuzz::require((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < 1e-6 && R.determinant() > 0,
                "a pose is a rigid motion");
  fuzz::require(pose->translation().cwiseAbs().maxCoeff() <= 100, "a pose is in this cell");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto kind = input.byte() % 3;
  const std::string text(input.text());
  if (kind == 0) check(parse_pose_json(text, "pose.json"));
  if (kind == 1) check(read_pose(text.find('/') == std::string::npos ? text : std::string("1,2")));
  if (kind == 2)
    if (const auto height_m = parse_table_height(text))
      fuzz::require(std::isfinite(*height_m), "a finite height");
  return 0;
}
