// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <future>

#include "core/capture/capture.hpp"
#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

using api::ApiError;
using api::CloudKind;
using namespace std::chrono_literals;

using LiveRecording = CellFixture;

api::CaptureRequest request(int postures, double timeout_s) {
  return {"eye", postures, api::Seconds(timeout_s), "a note"};
}

TEST_F(LiveRecording, IsACaptureWithItsRobotInIt) {
  auto recording = std::async(std::launch::async, [&] { return cell_->record_capture(request(1, 20)); });
  watch_until([&] { return recording.wait_for(0s) == std::future_status::ready; });
  const auto archive = recording.get();
  ASSERT_TRUE(archive) << archive.error().message();
  std::ofstream(folder_ / "capture.tar", std::ios::binary) << archive->tar;
  ASSERT_EQ(
      std::system(("tar -C " + folder_.string() + " -xf " + (folder_ / "capture.tar").string()).c_str()), 0);
  const auto unpacked = folder_ / archive->file_name.substr(0, archive->file_name.size() - 4);
  const auto capture = read_capture(unpacked, {});
  ASSERT_TRUE(capture) << capture.error().message();
  EXPECT_EQ(capture->note, "a note");
  EXPECT_EQ(capture->joint_names, model_->position_names());
  ASSERT_EQ(capture->views.size(), 1U);
  EXPECT_NEAR(capture->views[0].joint_positions_rad[0], 0.5, 1e-12);
  auto depth = capture->views[0].depth.raw;
  depth.back() = 1500;  // which changes from frame to frame
  EXPECT_EQ(depth, std::vector<std::uint16_t>(pixels(), 1500));
  EXPECT_TRUE(capture->views[0].image);
  EXPECT_TRUE(RobotModel::load(capture->urdf)) << "the meshes are in the archive";
}

TEST_F(LiveRecording, ThatDoesNotSeeItsPosturesSaysWhy) {
  const auto archive = cell_->record_capture(request(1, 0.2));
  ASSERT_FALSE(archive);
  EXPECT_EQ(archive.error().code, ApiError::postures_not_seen);
  EXPECT_NE(archive.error().detail.find("0 of 1"), std::string::npos);
}

TEST_F(LiveRecording, OneAtATimeAndLetGoAtTheEnd) {
  auto first = std::async(std::launch::async, [&] {
    for (;;) {  // until it is not the other one that came first
      auto recorded = cell_->record_capture(request(5, 600));
      if (recorded || recorded.error().code != ApiError::capture_in_progress) return recorded;
    }
  });
  wait_for(
      [&] { return cell_->record_capture(request(1, 0.001)).error().code == ApiError::capture_in_progress; });
  cell_->request_stop();
  EXPECT_EQ(first.get().error().code, ApiError::shutting_down);
}

TEST_F(LiveRecording, CloudsNeedFramesAndJoints) {
  const auto code = [&](CloudKind kind) { return cell_->cloud({"eye", kind, false}).error().code; };
  EXPECT_EQ(code(CloudKind::measured), ApiError::no_frame);
  EXPECT_EQ(code(CloudKind::virtual_), ApiError::no_joints);
  EXPECT_EQ(cell_->cloud({"other", CloudKind::measured, false}).error().code, ApiError::no_such_sensor);
}

TEST_F(LiveRecording, CloudsWithoutPoseOrGuessAreRefused) {
  guess_.reset();
  start();
  EXPECT_EQ(cell_->cloud({"eye", CloudKind::virtual_, false}).error().code, ApiError::no_pose);
}

TEST_F(LiveRecording, VirtualCloudLiesOnTheRobotAtTheStampedJoints) {
  calibrate();
  stand(0.0);
  const auto cloud = cell_->cloud({"eye", CloudKind::virtual_, true});
  ASSERT_TRUE(cloud) << cloud.error().message();
  EXPECT_EQ(cloud->frame, "base");
  EXPECT_TRUE(cloud->pose_valid);
  EXPECT_EQ(cloud->joint_positions_rad, (std::vector<double>{0, 0}));
  ASSERT_FALSE(cloud->points.empty());
  for (const auto& point :
       cloud->points)  // seen from 2 m above: the tops of base (0.1 m), arm (0.05 m) and hand (0)
    EXPECT_LT(std::min({std::abs(point.z() - 0.1F), std::abs(point.z() - 0.05F), std::abs(point.z())}),
              1e-5F);
}

TEST_F(LiveRecording, MeasuredCloudHasEveryMeasuredPixel) {
  watch_until([&] { return cell_->cloud({"eye", CloudKind::measured, false}).has_value(); });
  const auto cloud = cell_->cloud({"eye", CloudKind::measured, false});
  EXPECT_EQ(cloud->points.size(), pixels());
  EXPECT_FLOAT_EQ(cloud->points.front().z(), 1.5F);
  EXPECT_NEAR(cloud->points.front().x(), -15.5 / 30 * 1.5, 1e-6);
}

TEST_F(LiveRecording, ResidualIsMeasuredMinusPredictedDepth) {
  calibrate();
  watch_until([&] { return cell_->cloud({"eye", CloudKind::residual, false}).has_value(); });
  const auto cloud = cell_->cloud({"eye", CloudKind::residual, false});
  ASSERT_EQ(cloud->residual_m.size(), cloud->points.size());
  ASSERT_FALSE(cloud->points.empty());
  for (const float residual :
       cloud->residual_m)  // tops and sides lie 1.9 to 2.1 m below the sensor, 1.5 m is measured
    EXPECT_NEAR(residual, -0.5F, 0.101F);
}

}  // namespace
}  // namespace calibrd
