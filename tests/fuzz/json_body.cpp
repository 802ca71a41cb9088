// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The body of every route that takes one. Input: which route, then the body.
#include <array>

#include "api/routes/routes.hpp"
#include "tests/api/fake_cell.hpp"
#include "tests/api/fake_operations.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/response_check.hpp"

namespace {

using namespace calibrd;

constexpr std::array kPaths{"/api/v1/sensors/kinect2/calibrations", "/api/v1/cell/calibrations",
                            "/api/v1/sensors/kinect2/captures", "/api/v1/robot/motions"};

void check(const std::optional<Pose>& guess, std::optional<int> postures) {
  if (postures) fuzz::require(*postures >= 1 && *postures <= 50, "as many postures as allowed");
  if (!guess) return;
  const Eigen::Matrix3d R = guess->linear();
  fuzz::require((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < 1e-6 && R.determinant() > 0,
                "the guess is a rigid motion");
  fuzz::require(guess->translation().cwiseAbs().maxCoeff() <= 100, "the guess is in this cell");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto* const path = kPaths[input.byte() % kPaths.size()];
  api::FakeCell cell;
  cell.on_start = [&](const api::CalibrationRequest& request) {
    check(request.guess_T_base_sensor, request.postures);
    return cell.calibration_report;
  };
  cell.on_capture = [](const api::CaptureRequest& request) -> Result<api::CaptureArchive> {
    check({}, request.postures);
    fuzz::require(request.timeout.count() > 0 && request.timeout.count() <= 600, "a timeout in bounds");
    return api::CaptureArchive{"a.tar", "tar bytes"};
  };
  const api::EventHub events("run");
  const api::FakeOperations operations;
  const api::Router router = api::make_routes(cell, events, operations);
  fuzz::check_response(
      router.answer({"POST", path, {}, {{"content-type", "application/json"}}, std::string(input.text())}));
  check(cell.last_start_all.each.guess_T_base_sensor, cell.last_start_all.each.postures);
  return 0;
}
