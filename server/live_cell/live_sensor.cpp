// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/live_sensor.hpp"

#include <algorithm>
#include <utility>

#include "core/base/thread_name.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

constexpr auto kBlindAfter = 700ms;  ///< a pose must not be valid a second after the sensor was moved
constexpr auto kFramePatience = 100ms;
constexpr auto kJointsPatience = 10ms;  ///< less than a controller's cycle
constexpr std::size_t kRateFrames = 60;
constexpr std::size_t kMostPending = 15;  ///< frames that wait for joints: of controllers later than sensors

double seconds_of(Clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

}  // namespace

LiveSensor::LiveSensor(LiveSensorSettings settings, LiveRobot& robot, CheckFunction check,
                       std::function<void(const api::PoseReport&)> on_pose,
                       std::unique_ptr<DriftMonitor> monitor,
                       std::unique_ptr<TimeOffsetEstimator> time_offset)
    : settings_(std::move(settings)),
      robot_(robot),
      check_(std::move(check)),
      on_pose_(std::move(on_pose)),
      monitor_(std::move(monitor)),
      reach_(std::make_shared<const LinkReach>(robot.model())),
      offset_(std::move(time_offset), reach_, {.latency = settings_.gate.latency}),
      gate_(settings_.gate, reach_),
      watch_(settings_.watch) {}

LiveSensor::~LiveSensor() {
  request_stop();
  join();
}

void LiveSensor::join() {
  if (thread_.joinable()) thread_.join();
}

void LiveSensor::start(std::unique_ptr<DepthSource> source) {
  {
    const std::lock_guard lock(mutex_);  // others may be asking for the sensor already
    source_ = std::move(source);
  }
  thread_ = std::thread([this] { run(); });
}

void LiveSensor::run() {
  auto* source = source_.get();
  name_thread("sensor " + settings_.id);
  entered_at_ = Clock::now();
  while (!is_stopping_) {
    heartbeat_.beat();
    if (auto frame = source->next(pending_.empty() ? kFramePatience : kJointsPatience))
      take_up(*std::move(frame));
    notice_loss(source->health());
    settle();
    watch_offset();
    tell_of_pose();
  }
  std::unique_lock lock(mutex_);
  const auto ended = std::move(source_);
  lock.unlock();  // its destructor may take a moment
}

void LiveSensor::take_up(DepthFrame frame) {
  if (pending_.size() >= kMostPending) finish({FrameVerdict::awaiting_joints, std::nullopt});
  {
    const std::lock_guard lock(mutex_);
    arrivals_.push_back(frame.stamp);
    if (arrivals_.size() > kRateFrames) arrivals_.pop_front();
  }
  if (!has_size_of_camera(frame)) return note(FrameVerdict::wrong_size);
  if (const auto verdict = gate_.enter(frame.sequence, frame.stamp, &frame.depth);
      verdict != FrameVerdict::usable)
    return note(verdict);
  if (is_blind(Clock::now())) lose();  // also where it is the daemon that was stopped
  entered_at_ = Clock::now();
  auto& entered = *pending_.emplace_back(std::make_shared<Sighting>());
  entered.view.depth = std::move(frame.depth);
  entered.view.image = std::move(frame.image);
  entered.stamp = entered.exposed = frame.stamp;
}

bool LiveSensor::has_size_of_camera(const DepthFrame& frame) const {
  const auto& camera = settings_.camera;
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  const auto fits = [&](int width, int height, std::size_t count) {
    return width == camera.width && height == camera.height && count == pixels;
  };
  return fits(frame.depth.width, frame.depth.height, frame.depth.raw.size()) &&
         (!frame.image || fits(frame.image->width, frame.image->height, frame.image->pixels.size()));
}

void LiveSensor::settle() {
  while (!pending_.empty()) {
    auto decision = robot_.read_joints([this](const JointHistory& joints) {
      return gate_.judge(joints, pending_.front()->stamp, Clock::now());
    });
    if (decision.verdict == FrameVerdict::awaiting_joints) return;
    finish(std::move(decision));
  }
}

void LiveSensor::finish(FrameDecision decision) {
  const auto finished = std::move(pending_.front());
  pending_.pop_front();
  if (decision.positions_rad) finished->view.joint_positions_rad = *std::move(decision.positions_rad);
  if (decision.exposed != Clock::time_point()) finished->exposed = decision.exposed;
  finished->view.stamp_s = seconds_of(finished->exposed);
  const bool usable = decision.verdict == FrameVerdict::usable,
             timed = decision.verdict == FrameVerdict::timed;
  finished->view.is_moving = !usable;
  finished->timing_error_m = decision.timing_error_m;
  const std::shared_ptr<const Sighting> sighting = finished;
  note(decision.verdict);
  {
    const std::lock_guard lock(mutex_);
    newest_ = sighting;
    timing_error_m_ = decision.timing_error_m;
  }
  offset_.offer(sighting);
  serve_tasks(*sighting, usable || timed);
  watch(*sighting);
  if (usable || timed) check(*sighting);
}

std::vector<std::shared_ptr<CollectTask>> LiveSensor::open_tasks() {
  const std::lock_guard lock(mutex_);
  std::erase_if(tasks_, [](const auto& task) { return !task->is_open(); });
  return tasks_;
}

void LiveSensor::serve_tasks(const Sighting& sighting, bool usable) {
  const auto tasks = open_tasks();
  const bool is_of_use = usable && sighting.stamp > lost_at_;  // which only this thread writes
  for (const auto& task : tasks) is_of_use ? task->offer(sighting.view) : task->interrupt();
}

/// A sensor that was away, if only for a restart of its process, may have been moved. One whose frames are
/// all the same, or out of order, tells as little as one that sends none.
void LiveSensor::notice_loss(const SensorHealth& health) {
  const bool away = health.state != SensorHealth::State::streaming || is_blind(Clock::now());
  if (!away && health.restarts == restarts_) return;
  restarts_ = health.restarts;
  lose();
}

bool LiveSensor::is_blind(Clock::time_point now) const { return now - entered_at_.load() > kBlindAfter; }

/// Under mutex_. What the pose is worth to somebody who asks: the thread that watches it may itself be held
/// up, or have been stopped, and has not noticed yet that it has seen nothing for a while.
PoseWatch LiveSensor::worth_at(Clock::time_point now) const {
  auto worth = watch_;
  if (is_blind(now)) worth.on_sensor_lost();
  return worth;
}

void LiveSensor::lose() {
  {
    const std::lock_guard lock(mutex_);
    lost_at_ = Clock::now();
    watch_.on_sensor_lost();
  }
  if (monitor_) monitor_->on_sensor_lost();
  for (const auto& task : open_tasks()) task->start_over();
}

/// Poses that are not known to be right now must not teach it.
void LiveSensor::watch_offset() {
  std::optional<OffsetBasis> basis;
  {
    const std::lock_guard lock(mutex_);
    if (known_ && watch_.state() == api::PoseState::calibrated)
      basis = OffsetBasis{*known_->result.T_base_sensor, known_->result.depth_correction, pose_number_};
  }
  offset_.work(robot_, basis, robot_.connects() + restarts_);
  gate_.set_offset(offset_.applied());
}

void LiveSensor::note(FrameVerdict verdict) {
  const std::lock_guard lock(mutex_);
  verdict_ = verdict;
  ++counts_[static_cast<std::size_t>(verdict)];
}

void LiveSensor::tell_of_pose() {
  {
    const std::lock_guard lock(mutex_);
    const auto worth = worth_at(Clock::now());
    const Told now{pose_number_, worth.state(), known_ && worth.is_valid(Clock::now())};
    if (now == told_) return;
    told_ = now;
  }
  if (on_pose_) on_pose_(pose());
}

void LiveSensor::set_pose(api::PoseReport::Known known, const PoseOrigin& origin,
                          std::shared_ptr<const BackgroundMap> background) {
  const std::lock_guard lock(mutex_);
  if (monitor_) monitor_->set_pose(*known.result.T_base_sensor, std::move(background));
  // A pose of the future was stamped by a clock that was wrong then, or is now: it is not younger than new.
  const auto age = std::chrono::system_clock::now() - known.calibrated_at;
  calibrated_at_ = Clock::now() - std::max<Clock::duration>(age, Clock::duration::zero());
  known_ = std::move(known);
  evidence_.reset();
  ++pose_number_;
  if (origin.drifted)
    watch_.set_drifted();
  else if (!origin.objection.empty())
    watch_.set_withheld(origin.objection);
  else if (origin.seen_at)
    watch_.set_fresh(*origin.seen_at);
  else
    watch_.set_stored();
  // What was found before the sensor was lost, or moved once more, is not known to hold now.
  const bool moved = origin.seen_at && *origin.seen_at <= std::max(lost_at_, moved_at_);
  if (moved || origin.moved_since) watch_.on_sensor_lost();
}

bool LiveSensor::withhold(const std::string& calibration_id, const std::string& objection) {
  const std::lock_guard lock(mutex_);
  if (!known_ || known_->calibration_id != calibration_id) return false;
  watch_.set_withheld(objection);
  evidence_.reset();
  return true;
}

std::optional<Pose> LiveSensor::plausible_pose() const {
  const std::lock_guard lock(mutex_);
  return known_ && watch_.is_plausible() ? known_->result.T_base_sensor : std::nullopt;
}

void LiveSensor::set_evidence(PoseEvidence evidence, Clock::time_point seen_at) {
  const std::lock_guard lock(mutex_);
  if (seen_at > std::max(lost_at_, moved_at_)) evidence_ = std::move(evidence);
}

Clock::time_point LiveSensor::moved_at() const {
  const std::lock_guard lock(mutex_);
  return std::max(lost_at_, moved_at_);
}

std::optional<PoseEvidence> LiveSensor::evidence() const {
  const std::lock_guard lock(mutex_);
  if (evidence_ || !known_ || !watch_.is_plausible()) return evidence_;
  return PoseEvidence{*known_->result.T_base_sensor, known_->result.covariance, {}};
}

void LiveSensor::feed(std::shared_ptr<CollectTask> task) {
  const std::lock_guard lock(mutex_);
  tasks_.push_back(std::move(task));
}

std::shared_ptr<const Sighting> LiveSensor::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

}  // namespace calibrd
