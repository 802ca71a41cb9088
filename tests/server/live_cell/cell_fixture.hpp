// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <condition_variable>
#include <deque>
#include <fstream>
#include <numbers>
#include <thread>

#include "api/problem/api_error.hpp"
#include "server/live_cell/live_cell.hpp"

namespace calibrd {

/// A depth source whose frames a test hands over.
class FedSource : public DepthSource {
 public:
  struct Feed {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<DepthFrame> frames;
    SensorHealth health{SensorHealth::State::streaming, {}, 0, 0, 0, "fed", {}};
  };
  explicit FedSource(std::shared_ptr<Feed> feed) : feed_(std::move(feed)) {}

  std::optional<DepthFrame> next(std::chrono::milliseconds timeout) override {
    std::unique_lock lock(feed_->mutex);
    if (!feed_->changed.wait_for(lock, timeout, [&] { return !feed_->frames.empty(); })) return std::nullopt;
    std::optional<DepthFrame> frame(feed_->frames.front());
    feed_->frames.pop_front();
    return frame;
  }
  SensorHealth health() const override {
    const std::lock_guard lock(feed_->mutex);
    return feed_->health;
  }

 private:
  std::shared_ptr<Feed> feed_;
};

inline constexpr const char* kTwoJoints = R"(<robot name="two_joints">
<link name="base"><visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link>
<link name="arm"><visual><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.1 0.1"/></geometry></visual></link>
<link name="hand"><visual><geometry><mesh filename="package://arm/meshes/hand.stl"/></geometry></visual></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="1" effort="0"/></joint>
<joint name="bend" type="revolute"><origin xyz="0.6 0 0"/><parent link="arm"/><child link="hand"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="1" effort="0"/></joint></robot>)";

/// A live cell of a robot with two joints and one small sensor, "eye", whose frames, joints and verdicts a
/// test gives.
class CellFixture : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("calibrd_cell_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "models/arm/meshes");
    std::ofstream(folder_ / "robot.urdf") << kTwoJoints;
    std::ofstream(folder_ / "models/arm/meshes/hand.stl")
        << "solid hand\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.1 "
           "0\nendloop\n"
           "endfacet\nendsolid hand\n";
    auto model = RobotModel::load(folder_ / "robot.urdf", {{folder_ / "models"}, ""});
    ASSERT_TRUE(model) << model.error().message();
    model_ = std::make_unique<RobotModel>(*std::move(model));
    virtual_cell_ = std::make_unique<VirtualCell>(*model_);
    settings_.healing.mode = HealingMode::off;
    settings_.urdf = folder_ / "robot.urdf";
    settings_.search_paths = {folder_ / "models"};
    start();
  }
  void TearDown() override {
    cell_.reset();
    store_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// Starts the cell; a second call is a restart on the same store.
  void start() {
    cell_.reset();
    store_.reset();
    auto store = CalibrationStore::open(folder_ / "cell.db");
    ASSERT_TRUE(store) << store.error().message();
    store_ = *std::move(store);
    auto mapping =
        JointMapping::make(joints_in_wire_order(model_->position_names()), model_->position_names());
    ASSERT_TRUE(mapping) << mapping.error().message();
    cell_ = std::make_unique<LiveCell>(settings_, *model_, *virtual_cell_, *std::move(mapping), *store_,
                                       estimator(),
                                       CellLog{[this](const auto& report) { on_log_(report); },
                                               {},
                                               [this](const auto& error) { on_error_(error); }});
    ASSERT_TRUE(cell_->add_sensor({"eye", camera_, sensor_latency_, guess_, {}, mirror_}));
    feed_ = std::make_shared<FedSource::Feed>();
    cell_->start("eye", std::make_unique<FedSource>(feed_));
    events_ = cell_->robot_link().events();
    RobotLinkHealth health;
    health.state = RobotLinkHealth::State::streaming;
    events_.on_health(health);
  }

  Estimator estimator() {
    Estimator estimator;
    estimator.calibrate = [this](const CameraModel&, std::span<const View> views,
                                 const CalibrationSettings& settings) {
      return on_calibrate_(views, settings);
    };
    estimator.make_check = [this](const CameraModel&) -> CheckFunction {
      return [this](const View&, const Pose&, const DepthCorrection&, const Matrix6d&) {
        ++checks_;
        while (holds_checks_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return PoseCheck{checks_have_evidence_.load(), agrees_.load(), 0.9, 0, 4000};
      };
    };
    if (watches_)
      estimator.make_watch = [this](const CameraModel& camera, double) {
        return std::make_unique<DriftWatch>(*virtual_cell_, camera, DriftSettings{});
      };
    return estimator;
  }

  static CalibrationResult accepted(std::span<const View> views = {}) {
    CalibrationResult result;
    result.verdict = Verdict::accepted;
    result.T_base_sensor =
        Pose(Eigen::Translation3d(0.3, 0, 2) * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    result.views = static_cast<int>(views.size());
    return result;
  }

  /// Joints of the last half second, every 25 ms until now, standing still at a posture.
  void stand(double turn, double bend = 0) {
    const auto now = Clock::now();
    for (auto t = now - std::chrono::milliseconds(500); t <= now; t += std::chrono::milliseconds(25))
      events_.on_joints({0, {turn, bend, 0, 0, 0, 0, 0, 0, 0, 0}, {}, ++joints_sent_, t});
    events_.on_joints({0, {turn, bend, 0, 0, 0, 0, 0, 0, 0, 0}, {}, ++joints_sent_, now});
  }

  /// A frame of this moment minus 10 ms, every pixel as far away as the wall.
  void show() {
    DepthFrame frame;
    frame.depth = {camera_.width, camera_.height, 0.001, std::vector<std::uint16_t>(pixels(), wall_mm_)};
    frame.image = GreyImage{camera_.width, camera_.height, std::vector<std::uint16_t>(pixels(), 7)};
    frame.sequence = ++frames_sent_;
    frame.depth.raw.back() =
        static_cast<std::uint16_t>(wall_mm_ - 100 + frames_sent_ % 100);  // a sensor's noise
    frame.stamp = Clock::now() - std::chrono::milliseconds(10);
    const std::lock_guard lock(feed_->mutex);
    feed_->frames.push_back(std::move(frame));
    feed_->changed.notify_all();
  }
  std::size_t pixels() const { return static_cast<std::size_t>(camera_.width * camera_.height); }

  /// Repeats `step` until `done`, and fails the test when that takes too long.
  template <class Step, class Done>
  void repeat_until(Step step, Done done) {
    const auto deadline = Clock::now() + std::chrono::seconds(20);
    while (!done()) {
      ASSERT_LT(Clock::now(), deadline) << "waited in vain";
      step();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  template <class Done>
  void wait_for(Done done) {
    repeat_until([] {}, done);
  }

  api::CalibrationReport job(const std::string& id) { return *cell_->calibration(id); }
  Result<api::CalibrationReport> start_job(int postures, const std::string& key = {}) {
    api::CalibrationRequest request;
    request.sensor_id = "eye";
    request.postures = postures;
    request.idempotency_key = key;
    request.fingerprint = std::to_string(postures);
    return cell_->start_calibration(request);
  }
  /// Moves from posture to posture until the job has ended.
  void let_it_end(const std::string& id) {
    repeat_until(
        [&] {
          stand(0.3 * (1 + job(id).postures_seen));
          show();
        },
        [&] { return job(id).finished.has_value(); });
  }
  /// Stands still and shows frames until `done`.
  template <class Done>
  void watch_until(Done done) {
    repeat_until(
        [&] {
          stand(0.5);
          show();
        },
        done);
  }
  /// Checks that agree do not make the pose valid.
  void expect_checks_change_nothing() {
    const auto frames = frames_sent_;
    watch_until([&] { return frames_sent_ >= frames + 50; });
    EXPECT_FALSE(pose().valid);
  }
  void set_health(SensorHealth::State state) {
    const std::lock_guard lock(feed_->mutex);
    feed_->health.state = state;
  }
  /// A calibration that has been accepted, but waits to be activated.
  std::string calibrate_without_activating() {
    api::CalibrationRequest request;
    request.sensor_id = "eye";
    request.postures = 1;
    request.activate = false;
    const auto started = cell_->start_calibration(request);
    EXPECT_TRUE(started);
    let_it_end(started->id);
    return started->id;
  }
  /// A calibration that has been accepted.
  std::string calibrate() {
    const auto started = start_job(1);
    EXPECT_TRUE(started);
    let_it_end(started->id);
    return started->id;
  }
  api::PoseReport pose() { return *cell_->pose("eye"); }

  std::filesystem::path folder_;
  CameraModel camera_{32, 24, 30, 30, 15.5, 11.5, {0, 0, 0, 0, 0}};
  Clock::duration sensor_latency_{0};
  std::optional<Pose> guess_ = Pose::Identity();
  bool mirror_ = false, watches_ = false;
  std::uint16_t wall_mm_ = 1500;
  LiveCellSettings settings_ = [] {
    LiveCellSettings settings;
    settings.watch.check_period = std::chrono::milliseconds(5);
    settings.watch.recheck_period = std::chrono::milliseconds(5);
    settings.watch.least_drift = std::chrono::milliseconds(50);
    settings.gate.settle_time = std::chrono::milliseconds(100);
    settings.gate.lateness = Clock::duration(0);  // each step would wait for joints that no test sends
    return settings;
  }();
  std::unique_ptr<RobotModel> model_;
  std::unique_ptr<VirtualCell> virtual_cell_;
  std::unique_ptr<CalibrationStore> store_;
  std::unique_ptr<LiveCell> cell_;
  std::shared_ptr<FedSource::Feed> feed_;
  RobotLinkEvents events_;
  std::uint64_t joints_sent_ = 0, frames_sent_ = 0;
  std::atomic<int> checks_{0};
  std::atomic<bool> agrees_{true}, checks_have_evidence_{true};
  std::atomic<bool> holds_checks_{false};  // the thread that watches the sensor with them
  std::function<void(const api::CalibrationReport&)> on_log_ = [](const auto&) {};
  std::function<void(const std::string&)> on_error_ = [](const auto&) {};
  std::function<CalibrationResult(std::span<const View>, const CalibrationSettings&)> on_calibrate_ =
      [](std::span<const View> views, const CalibrationSettings&) { return accepted(views); };
};

}  // namespace calibrd
