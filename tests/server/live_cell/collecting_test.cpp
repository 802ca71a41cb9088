// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What becomes of a calibration that is collecting postures when its sensor goes and comes back.
#include <gmock/gmock.h>

#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

using api::JobStatus;
using testing::HasSubstr;

class Collecting : public CellFixture {
 protected:
  Collecting() {
    on_log_ = [this](const api::CalibrationReport& report) {
      const std::lock_guard lock(log_mutex_);
      log_.push_back(report);
    };
    on_calibrate_ = [this](auto views, const auto&) {
      for (const View& view : views) stamps_s_.push_back(view.stamp_s);
      return accepted(views);
    };
  }
  void see_postures(const std::string& id, int postures) {
    repeat_until(
        [&] {
          stand(0.3 * (1 + job(id).postures_seen));
          show();
        },
        [&] { return job(id).postures_seen >= postures; });
  }
  std::vector<api::CalibrationReport> log() {
    const std::lock_guard lock(log_mutex_);
    return log_;
  }
  void wait_for_drop(const std::string& id) {
    wait_for([&] { return job(id).postures_seen == 0; });
  }
  /// Frames that come late, of a sensor that is lost.
  void expect_frames_do_not_count(const std::string& id) {
    const auto views = cell_->sensor("eye")->views.views;
    watch_until([&] { return cell_->sensor("eye")->views.views > views + 10; });
    EXPECT_EQ(job(id).postures_seen, 0);
  }
  void expect_views_after(double loss_s) {
    EXPECT_EQ(stamps_s_.size(), 3U);
    for (const double stamp_s : stamps_s_) EXPECT_GT(stamp_s, loss_s);
  }
  static double now_s() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

  std::vector<double> stamps_s_, progress_;
  std::string id_;

 private:
  std::mutex log_mutex_;
  std::vector<api::CalibrationReport> log_;
};

TEST_F(Collecting, NeverMixesViewsOfBeforeAndAfterALossOfTheSensor) {
  const auto id = start_job(3)->id;
  see_postures(id, 2);
  set_health(SensorHealth::State::lost);
  wait_for_drop(id);
  expect_frames_do_not_count(id);
  const double loss_s = now_s();
  EXPECT_THAT(job(id).message, HasSubstr("0 of 3 postures; 2 more dropped when the sensor was lost"));
  ASSERT_EQ(log().size(), 1U);
  EXPECT_EQ(log()[0].status, JobStatus::collecting);
  EXPECT_THAT(log()[0].message, HasSubstr("2 more dropped"));
  set_health(SensorHealth::State::streaming);
  let_it_end(id);
  EXPECT_EQ(job(id).status, JobStatus::succeeded);
  expect_views_after(loss_s);
}

TEST_F(Collecting, StartsOverWhenTheSensorsProcessWasRestarted) {
  const auto id = start_job(3)->id;
  see_postures(id, 1);
  const double loss_s = now_s();
  {
    const std::lock_guard lock(feed_->mutex);
    ++feed_->health.restarts;
  }
  wait_for_drop(id);
  let_it_end(id);
  expect_views_after(loss_s);
}

TEST_F(Collecting, EndsAtItsTimeLimitAndTellsOfTheLoss) {
  settings_.jobs.collect_timeout = std::chrono::seconds(1);
  start();
  const auto id = start_job(3)->id;
  see_postures(id, 1);
  set_health(SensorHealth::State::lost);
  wait_for([&] { return job(id).finished.has_value(); });
  EXPECT_EQ(job(id).status, JobStatus::failed);
  EXPECT_THAT(job(id).message, HasSubstr("Only 0 of 3 postures"));
  EXPECT_THAT(job(id).message, HasSubstr("1 more dropped"));
}

TEST_F(Collecting, SaysThatTheSensorIsLostAndNotWhatItsLastFrameShowed) {
  settings_.jobs.collect_timeout = std::chrono::seconds(1);
  start();
  const auto id = start_job(1)->id;
  repeat_until([&] { show(); }, [&] { return !cell_->sensor("eye")->views.refused.empty(); });
  ASSERT_THAT(job(id).message, HasSubstr("joint positions"));
  {
    const std::lock_guard lock(feed_->mutex);
    feed_->health.reason = "unplugged; plug it in";
  }
  set_health(SensorHealth::State::lost);
  EXPECT_THAT(job(id).message, HasSubstr("0 of 1 postures; the sensor is lost: unplugged; plug it in"));
  EXPECT_THAT(cell_->record_capture({"eye", 1, api::Seconds(0.01), ""}).error().detail,
              HasSubstr("0 of 1 postures; the sensor is lost: unplugged; plug it in"));
  wait_for([&] { return job(id).finished.has_value(); });
  EXPECT_THAT(job(id).message, HasSubstr("Last: the sensor is lost: unplugged; plug it in"));
}

TEST_F(Collecting, ProgressNeverFalls) {
  on_calibrate_ = [this](auto views, const CalibrationSettings& settings) {
    for (const double share : {0.0, 0.4, 0.2, 1.0}) {
      settings.on_progress(share);
      progress_.push_back(job(id_).progress);
    }
    return accepted(views);
  };
  id_ = start_job(2)->id;
  EXPECT_EQ(job(id_).progress, 0);
  see_postures(id_, 1);
  EXPECT_EQ(job(id_).progress, 0.25);
  set_health(SensorHealth::State::lost);
  wait_for_drop(id_);
  EXPECT_EQ(job(id_).progress, 0.25);
  set_health(SensorHealth::State::streaming);
  let_it_end(id_);
  EXPECT_EQ(progress_, (std::vector<double>{0.5, 0.7, 0.7, 1.0}));
  EXPECT_EQ(job(id_).progress, 1);
}

TEST_F(Collecting, BeginsToComputeWithHalfOfTheProgress) {
  std::atomic<bool> may_end{false};
  on_calibrate_ = [&](auto views, const auto&) {
    while (!may_end) std::this_thread::yield();
    return accepted(views);
  };
  const auto id = start_job(1)->id;
  watch_until([&] { return job(id).status == JobStatus::running; });
  EXPECT_EQ(job(id).progress, 0.5);
  may_end = true;
  wait_for([&] { return job(id).finished.has_value(); });
}

TEST(CollectTask, KeepsItsViewsOnceItIsComplete) {
  CollectTask task({1, 0.17, 1});
  View view;
  view.depth = {1, 1, 0.001, {1000}};
  view.joint_positions_rad = {0};
  task.offer(view);
  task.start_over();
  EXPECT_TRUE(task.is_complete());
  EXPECT_EQ(task.take_views().size(), 1U);
  EXPECT_EQ(task.dropped(), 0);
}

}  // namespace
}  // namespace calibrd
