// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/registration/contour_edges.hpp"
#include "tests/core/registration/scene.hpp"
#include "tests/core/virtual_cell/picture.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kEdgeOutside_px = 1.3;

/// A board that fills one side of the picture; its edge runs through it. `along_x`: the edge is crossed along
/// the image's x axis (else along y). The sensor stands askew in the base frame.
struct Board {
  explicit Board(bool along_x)
      : crossed_along_x(along_x),
        robot(robot_from(link(
            "base",
            box_shape({2, 2, 0.05}, skew_pose() * shift(along_x ? -0.9 : 0, along_x ? 0 : -0.9, 1.025))))),
        cell(robot) {}

  /// Where the picture of the board ends along the crossing line through `place` (px across), from a pose.
  double edge(const Pose& T_base_sensor, double place) const {
    double inside = 80, outside = 0.5 * (crossed_along_x ? camera.width : camera.height) + 70;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (inside + outside);
      const Eigen::Vector3d ray = crossed_along_x ? camera.ray(middle, place) : camera.ray(place, middle);
      (cell.hit_along(ray, T_base_sensor).depth_m > 0 ? inside : outside) = middle;
    }
    return inside;
  }

  bool crossed_along_x;
  RobotModel robot;
  VirtualCell cell;
  CameraModel camera{321, 241, 260, 255, 150, 110, {0.05, -0.1, 0, 0, 0}};
};

/// An image that is blank but for one line across the edge, where it steps from dark to bright.
RegistrationView view_with_one_step(const Board& board, int place, double step_at_px) {
  const CameraModel& camera = board.camera;
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  RegistrationView view{board.cell,
                        {},
                        JointAxes(board.robot, board.cell.link_poses()),
                        std::vector<float>(pixels, 0.0F),
                        std::vector<float>(pixels, 100.0F),
                        1.0,
                        std::make_shared<const PixelRays>(camera)};
  const int length = board.crossed_along_x ? camera.width : camera.height;
  for (int t = 0; t < length; ++t) {
    const int x = board.crossed_along_x ? t : place, y = board.crossed_along_x ? place : t;
    view.image[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
               static_cast<std::size_t>(x)] =
        100.0F + 500.0F / (1 + std::exp(static_cast<float>(-1.5 * (t - step_at_px))));
  }
  return view;
}

class ContourJacobian : public testing::TestWithParam<bool> {};

TEST_P(ContourJacobian, EqualsTheSlopeOfTheRenderedOutline) {
  const Board board(GetParam());
  const Pose T_base_sensor = skew_pose();
  for (const int place : {40, 110, 190}) {
    const double edge_px = board.edge(T_base_sensor, place);
    const RegistrationView view = view_with_one_step(board, place, edge_px + kEdgeOutside_px);
    ContourSettings settings;
    NormalEquations equations;
    ContourTally tally;
    const auto contour = find_contour(view, measured(board.cell, board.camera, T_base_sensor), board.camera,
                                      T_base_sensor, {1, 1, {}});
    std::vector<Sample> samples;
    observe_contour(view, contour, board.camera, T_base_sensor, settings, samples, tally);
    for (const Sample& sample : samples) equations.add(sample.observation, sample.cluster);
    ASSERT_EQ(tally.found, 1U) << "of " << tally.predicted;
    const ParameterMatrix information = equations.information().selfadjointView<Eigen::Lower>();
    const double weight = information(kImageShift, kImageShift);  // w J Jᵀ, where J is 1 for the shift
    const ParameterVector jacobian = information.col(kImageShift) / weight;
    EXPECT_NEAR(equations.gradient()[kImageShift] / weight, kEdgeOutside_px, 0.25);  // outward is positive

    constexpr double kStep = 1e-3;
    Vector6d slope;
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = kStep * Vector6d::Unit(k);
      slope[k] = (board.edge(perturbed(T_base_sensor, step), place) -
                  board.edge(perturbed(T_base_sensor, -step), place)) /
                 (2 * kStep);
    }
    EXPECT_LT((jacobian.head<6>() - slope).norm(), 0.01 * slope.norm())
        << jacobian.head<6>().transpose() << "\n"
        << slope.transpose();
    EXPECT_EQ(jacobian[kOffset], 0);
    EXPECT_EQ(jacobian[kScale], 0);
  }
}

INSTANTIATE_TEST_SUITE_P(, ContourJacobian, testing::Bool(), [](const auto& test) {
  return test.param ? "AcrossAnUprightEdge" : "AcrossALevelEdge";
});

/// The views' sums at `T_base_sensor`, contours alone.
NormalEquations contour_sums(std::span<const RegistrationView> views, const CameraModel& camera,
                             const Pose& T_base_sensor, const ContourSettings& settings,
                             ContourTally& tally) {
  NormalEquations sums;
  for (const RegistrationView& view : views) {
    NormalEquations of_view;
    const auto contour =
        find_contour(view, measured(view.cell, camera, T_base_sensor), camera, T_base_sensor, {});
    std::vector<Sample> samples;
    observe_contour(view, contour, camera, T_base_sensor, settings, samples, tally);
    for (const Sample& sample : samples) of_view.add(sample.observation, sample.cluster);
    sums.merge(of_view);
  }
  return sums;
}

class ContourStep : public testing::TestWithParam<bool> {};

// The sensor is assumed 2 mm and 2 mrad off: one step on the outline alone brings it most of the way back.
TEST_P(ContourStep, PullsThePoseBackToTheTruth) {
  SceneSettings scene;
  scene.images = true;
  const std::vector<View> views = render_views(3, scene);
  const auto prepared = prepare_views(VirtualCell(test_arm()), scene.camera, views, {});
  const Pose start = off_by(true_T_base_sensor(), 0.002, 0.002, 4);
  ContourSettings settings;
  settings.fit_profile = GetParam();
  settings.search_px = settings.kernel_px = 3;
  ContourTally tally;
  const NormalEquations sums = contour_sums(prepared, scene.camera, start, settings, tally);
  EXPECT_GT(tally.found, tally.predicted / 2);
  ParameterMatrix information = sums.information().selfadjointView<Eigen::Lower>();
  for (int k = kOffset; k < kParameters; ++k) information(k, k) += 1e9;  // nothing but the pose
  const ParameterVector delta = information.ldlt().solve(sums.gradient());
  const Pose end = perturbed(start, delta.head<6>());
  const Eigen::Vector3d on_robot(0, 0, 1.4);  // the outline sees across the line of sight, at the robot
  const auto across_m = [&](const Pose& pose) {
    return (true_T_base_sensor().inverse() * pose * on_robot - on_robot).head<2>().norm();
  };
  EXPECT_LT(across_m(end), 0.4e-3);
  EXPECT_GT(across_m(start), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(, ContourStep, testing::Bool(),
                         [](const auto& test) { return test.param ? "ByProfile" : "BySteepestStep"; });

TEST(ContourEdges, DoNothingWithoutAnImage) {
  const std::vector<View> views = render_views(1);
  const auto prepared = prepare_views(VirtualCell(test_arm()), ideal_kinect2(), views, {});
  ContourTally tally;
  const NormalEquations sums = contour_sums(prepared, ideal_kinect2(), true_T_base_sensor(), {}, tally);
  EXPECT_EQ(tally.predicted, 0U);
  EXPECT_EQ(sums.count(), 0U);
}

TEST(ContourEdges, BlankImageHoldsNoEdge) {
  std::vector<View> views = render_views(1);
  views[0].image = GreyImage{512, 424, std::vector<std::uint16_t>(512 * 424, 700)};
  const auto prepared = prepare_views(VirtualCell(test_arm()), ideal_kinect2(), views, {});
  ContourTally tally;
  const NormalEquations sums = contour_sums(prepared, ideal_kinect2(), true_T_base_sensor(), {}, tally);
  EXPECT_GT(tally.predicted, 100U);
  EXPECT_EQ(tally.found, 0U);
  EXPECT_EQ(sums.count(), 0U);
}

TEST(ContourEdges, BehindSomethingInFrontAreLeftOut) {
  SceneSettings scene;
  scene.images = true;
  ContourTally open, hidden;
  for (const double share : {0.0, 1.0}) {
    scene.hidden_share = share;
    const std::vector<View> views = render_views(1, scene);
    const auto prepared = prepare_views(VirtualCell(test_arm()), scene.camera, views, {});
    contour_sums(prepared, scene.camera, true_T_base_sensor(), {}, share > 0 ? hidden : open);
  }
  EXPECT_GT(open.predicted, 100U);
  EXPECT_EQ(hidden.predicted, 0U);
}

}  // namespace
}  // namespace calibrd
