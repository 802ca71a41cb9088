// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Frames and joints in step: what is out of step gives no view, and the API says why.
#include "tests/core/registration/scene.hpp"
#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

class InStep : public CellFixture {
 protected:
  api::ViewReport views() { return cell_->sensor("eye")->views; }
  std::uint64_t refused(const std::string& code) {
    const auto counts = views().refused;
    const auto found = std::ranges::find(counts, code, &std::pair<std::string, std::uint64_t>::first);
    return found == counts.end() ? 0 : found->second;
  }
  void say_in_motion(bool in_motion) {
    ControllerStatus status;
    status.in_motion = in_motion;
    status.stamp = Clock::now();
    events_.on_status(status);
  }
  void show_frame(std::uint64_t sequence, std::uint16_t depth, Clock::time_point stamp) {
    DepthFrame frame;
    frame.depth = {camera_.width, camera_.height, 0.001, std::vector<std::uint16_t>(pixels(), depth)};
    frame.sequence = sequence;
    frame.stamp = stamp;
    const std::lock_guard lock(feed_->mutex);
    feed_->frames.push_back(std::move(frame));
    feed_->changed.notify_all();
  }
};

TEST_F(InStep, JointsThatRepeatWhileTheControllerSaysItMovesAreFrozenInTheApi) {
  repeat_until(
      [&] {
        events_.on_joints({0, {0.5, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {}, ++joints_sent_, Clock::now()});
        say_in_motion(true);
        show();
      },
      [&] { return refused("joints_frozen") > 0; });
  EXPECT_EQ(views().views, 0U);
  EXPECT_NE(views().reason.find("repeat"), std::string::npos) << views().reason;
  EXPECT_TRUE(cell_->robot().joints_frozen);
  // The robot has come to rest, where nobody knows: no view before the joints change.
  const auto before = refused("joints_frozen");
  repeat_until(
      [&] {
        events_.on_joints({0, {0.5, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {}, ++joints_sent_, Clock::now()});
        say_in_motion(false);
        show();
      },
      [&] { return refused("joints_frozen") > before + 20; });
  EXPECT_EQ(views().views, 0U);
  const auto cloud = cell_->cloud({"eye", api::CloudKind::residual, false});
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, make_error_code(api::ApiError::joints_stale)) << cloud.error().message();
  const auto virtual_cloud = cell_->cloud({"eye", api::CloudKind::virtual_, false});
  ASSERT_FALSE(virtual_cloud);
  EXPECT_EQ(virtual_cloud.error().code, make_error_code(api::ApiError::joints_stale));
  repeat_until(
      [&] {
        stand(0.7);
        show();
      },
      [&] { return views().views > 0; });
}

TEST_F(InStep, AControllerThatSaysItMovesAllTheTimeCanBeIgnored) {
  settings_.gate.trust_in_motion = false;
  start();
  repeat_until(
      [&] {
        stand(0.5);
        say_in_motion(true);
        show();
      },
      [&] { return views().views > 20; });
  EXPECT_EQ(refused("joints_frozen"), 0U);
}

TEST_F(InStep, RepeatedAndOlderFramesAreRefusedByName) {
  stand(0.5);
  const auto now = Clock::now() - 60ms;
  show_frame(1, 1500, now);
  show_frame(1, 1501, now + 5ms);   // the number again
  show_frame(2, 1502, now);         // the stamp again
  show_frame(3, 1500, now + 10ms);  // the pixels again
  show_frame(4, 1503, now + 5ms);   // older
  show_frame(2, 1504, now + 15ms);  // an earlier number
  wait_for([&] { return refused("repeated") == 3 && refused("out_of_order") == 2; });
  wait_for([&] { return views().views == 1; });
}

TEST_F(InStep, FramesWaitForTheJointsOfALateController) {
  settings_.joint_latency = 120ms;  // several frame periods
  start();
  std::vector<double> turns;
  repeat_until(
      [&] {
        stand(0.5);
        show();
        std::this_thread::sleep_for(20ms);
      },
      [&] { return views().views > 10; });
  EXPECT_EQ(refused("awaiting_joints"), 0U);
}

TEST_F(InStep, CloudsCarryTheMomentTheirJointsAreOf) {
  const auto started = start_job(1);
  ASSERT_TRUE(started);
  let_it_end(started->id);
  std::this_thread::sleep_for(200ms);  // so long the joints below stand
  stand(0.9);
  const auto stamp = Clock::now() - 20ms;
  show_frame(100'000, 1777, stamp);
  wait_for([&] {
    const auto cloud = cell_->cloud({"eye", api::CloudKind::residual, false});
    return cloud && cloud->frame_stamp_ns == stamp.time_since_epoch() / 1ns &&
           cloud->joint_stamp_ns == cloud->frame_stamp_ns && cloud->joint_positions_rad.front() == 0.9;
  });
}

TEST_F(InStep, AFrameThatCameLateIsOfTheMomentItWasExposed) {
  sensor_latency_ = 30ms;
  start();
  calibrate();
  watch_until([&] { return pose().valid; });
  std::this_thread::sleep_for(200ms);
  stand(0.9);
  const auto stamp = Clock::now() - 20ms;
  show_frame(100'000, 1777, stamp);
  wait_for([&] {
    const auto cloud = cell_->cloud({"eye", api::CloudKind::residual, false});
    return cloud && cloud->frame_stamp_ns == (stamp - 30ms).time_since_epoch() / 1ns;
  });
  const auto merged = cell_->merged_cloud({});
  ASSERT_TRUE(merged);
  ASSERT_EQ(merged->parts.size(), 1U);
  EXPECT_EQ(merged->parts[0].stamp, stamp - 30ms);
}

/// A sensor that looks at the test arm, whose frames and joints are handed over with known lateness.
class OffsetWatchTest : public ::testing::Test {
 protected:
  static constexpr auto kLate = 45ms;
  static std::vector<double> joints_at(Clock::time_point time) {
    const double t = std::chrono::duration<double>(time - Clock::time_point(1h)).count();
    auto joints = test::postures(1).front();
    joints[0] += 0.35 * std::sin(1.3 * t);
    joints[1] += 0.2 * std::sin(0.9 * t + 1);
    return joints;
  }
  void report_until(Clock::time_point time) {
    for (; sent_ <= time; sent_ += 25ms) {
      auto positions = joints_at(sent_);
      positions.resize(10);
      events_.on_joints({0, positions, {}, ++sequence_, sent_});
    }
  }
  void see(int frames) {
    for (int i = 0; i < frames; ++i) {
      exposed_ += 160ms;
      test::SceneSettings scene;
      scene.seed = ++sequence_;
      auto sighting = std::make_shared<Sighting>();
      sighting->view = test::render_view(joints_at(exposed_), test::true_T_base_sensor(), scene);
      sighting->stamp = sighting->exposed = exposed_ + kLate;
      watch_.offer(sighting);
      watch_.work(robot_, basis_, link_);  // too early: its joints are still to come
      report_until(exposed_ + 400ms);
      watch_.work(robot_, basis_, link_);
    }
  }

  LiveRobot robot_{test::test_arm(),
                   *JointMapping::make(joints_in_wire_order(test::test_arm().position_names()),
                                       test::test_arm().position_names()),
                   {},
                   Clock::duration(0),
                   {}};
  RobotLinkEvents events_ = robot_.events();
  OffsetWatch watch_{
      std::make_unique<TimeOffsetEstimator>(VirtualCell(test::test_arm()), test::ideal_kinect2()),
      std::make_shared<const LinkReach>(test::test_arm()),
      {}};
  std::optional<OffsetBasis> basis_ = OffsetBasis{test::true_T_base_sensor(), {}, 1};
  std::uint64_t link_ = 1, sequence_ = 0;
  Clock::time_point exposed_ = Clock::now(), sent_ = exposed_ - 1s;
};

TEST_F(OffsetWatchTest, IsAppliedOnceItIsKnownAndForgottenWithTheLink) {
  see(60);
  ASSERT_TRUE(watch_.applied()) << watch_.report(Clock::now()).reason;
  EXPECT_NEAR(std::chrono::duration<double>(watch_.applied()->value).count(), 0.045, 0.003);
  EXPECT_TRUE(watch_.report(Clock::now()).applied);
  basis_->pose_number = 2;  // another pose: the offset stays
  see(3);
  EXPECT_TRUE(watch_.applied());
  ++link_;
  see(1);
  EXPECT_FALSE(watch_.applied());
  EXPECT_FALSE(watch_.report(Clock::now()).reason.empty());
}

TEST_F(OffsetWatchTest, NothingIsEstimatedWithoutAPose) {
  basis_.reset();
  see(10);
  EXPECT_FALSE(watch_.applied());
  EXPECT_NE(watch_.report(Clock::now()).reason.find("calibrate"), std::string::npos);
}

}  // namespace
}  // namespace calibrd
