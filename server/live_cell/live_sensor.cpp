// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/live_sensor.hpp"

#include <algorithm>

namespace calibrd {
namespace {

using namespace std::chrono_literals;

constexpr auto kFramePatience = 100ms;
constexpr auto kJointsPatience = 10ms;  ///< less than a controller's cycle
constexpr std::size_t kRateFrames = 60;
constexpr std::size_t kMostPending = 15;  ///< frames that wait for joints: of controllers later than sensors
constexpr auto kRateWindow = 2s;

const char* name_of(SensorHealth::State state) {
  switch (state) {
    case SensorHealth::State::starting:
      return "starting";
    case SensorHealth::State::streaming:
      return "streaming";
    case SensorHealth::State::lost:
      return "lost";
  }
  return "lost";
}

double seconds_of(Clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

}  // namespace

LiveSensor::LiveSensor(LiveSensorSettings settings, LiveRobot& robot, CheckFunction check,
                       std::function<void(const api::PoseReport&)> on_pose,
                       std::unique_ptr<TimeOffsetEstimator> time_offset)
    : settings_(std::move(settings)),
      robot_(robot),
      check_(std::move(check)),
      on_pose_(std::move(on_pose)),
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
  while (!is_stopping_) {
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
  const std::shared_ptr<const Sighting> sighting = finished;
  note(decision.verdict);
  {
    const std::lock_guard lock(mutex_);
    newest_ = sighting;
    timing_error_m_ = decision.timing_error_m;
  }
  offset_.offer(sighting);
  serve_tasks(*sighting, usable || timed);
  if (usable) check(*sighting);
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

/// A sensor that was away, if only for a restart of its process, may have been moved.
void LiveSensor::notice_loss(const SensorHealth& health) {
  const bool away = health.state != SensorHealth::State::streaming;
  if (!away && health.restarts == restarts_) return;
  restarts_ = health.restarts;
  {
    const std::lock_guard lock(mutex_);
    lost_at_ = Clock::now();
    watch_.on_sensor_lost();
  }
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

void LiveSensor::check(const Sighting& sighting) {
  std::unique_lock lock(mutex_);
  if (!known_ || sighting.stamp <= lost_at_ || !watch_.is_check_due(Clock::now())) return;
  const auto number = pose_number_;
  const auto pose = *known_->result.T_base_sensor;
  const auto correction = known_->result.depth_correction;
  lock.unlock();
  const auto checked = check_(sighting.view, pose, correction);
  lock.lock();
  if (number != pose_number_) return;
  const bool was_plausible = watch_.is_plausible();
  watch_.on_check(checked, Clock::now());
  if (was_plausible && !watch_.is_plausible())
    evidence_.reset();  // it was found where the sensor stood before
}

void LiveSensor::note(FrameVerdict verdict) {
  const std::lock_guard lock(mutex_);
  verdict_ = verdict;
  ++counts_[static_cast<std::size_t>(verdict)];
}

void LiveSensor::tell_of_pose() {
  {
    const std::lock_guard lock(mutex_);
    const Told now{pose_number_, watch_.state(), known_ && watch_.is_valid(Clock::now())};
    if (now == told_) return;
    told_ = now;
  }
  if (on_pose_) on_pose_(pose());
}

void LiveSensor::set_pose(api::PoseReport::Known known, const PoseOrigin& origin) {
  const std::lock_guard lock(mutex_);
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
  if (origin.seen_at && *origin.seen_at <= lost_at_) watch_.on_sensor_lost();
}

std::optional<Pose> LiveSensor::plausible_pose() const {
  const std::lock_guard lock(mutex_);
  return known_ && watch_.is_plausible() ? known_->result.T_base_sensor : std::nullopt;
}

void LiveSensor::set_evidence(PoseEvidence evidence) {
  const std::lock_guard lock(mutex_);
  evidence_ = std::move(evidence);
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

api::PoseReport LiveSensor::pose() const {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  api::PoseReport report;
  report.sensor_id = settings_.id;
  report.base_frame = robot_.model().base_link();
  report.sensor_frame = settings_.id + "_optical";
  report.state = watch_.state();
  report.valid = known_ && watch_.is_valid(now);
  report.reason = watch_.reason(now);
  report.known = known_;
  report.last_check = watch_.last_check(now);
  report.passed_check_age = watch_.passed_check_age(now);
  report.max_unverified = settings_.watch.max_unverified;
  return report;
}

api::SensorReport LiveSensor::report() const {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  SensorHealth health;
  if (source_) health = source_->health();
  api::SensorReport report;
  report.id = settings_.id;
  report.health = name_of(health.state);
  report.reason = health.reason;
  if (health.state == SensorHealth::State::starting && health.reason.empty())
    report.reason = "the device is being opened; this can take some seconds";
  report.device = health.device;
  report.notice = health.notice;
  report.frames = health.frames;
  report.frames_lost = health.frames_lost;
  report.restarts = health.restarts;
  report.frame_rate_hz = frame_rate_hz(now);
  if (!arrivals_.empty()) report.frame_age = now - arrivals_.back();
  report.camera = settings_.camera;
  report.has_image = newest_ && newest_->view.image;
  report.views.usable = verdict_ == FrameVerdict::usable || verdict_ == FrameVerdict::timed;
  report.views.timing_error_m = timing_error_m_;
  report.time_offset = offset_.report(now);
  report.views.code = name_of(verdict_);
  report.views.reason = reason_of(verdict_);
  report.views.moving_views = counts_[static_cast<std::size_t>(FrameVerdict::timed)];
  report.views.views = counts_[static_cast<std::size_t>(FrameVerdict::usable)] + report.views.moving_views;
  for (std::size_t i = 1; i < kFrameVerdicts; ++i)
    if (counts_[i] > 0 && static_cast<FrameVerdict>(i) != FrameVerdict::timed)
      report.views.refused.emplace_back(name_of(static_cast<FrameVerdict>(i)), counts_[i]);
  report.pose_state = watch_.state();
  report.pose_valid = known_ && watch_.is_valid(now);
  return report;
}

/// What became of the last frame says nothing of a sensor that sends none.
std::string LiveSensor::hindrance() const {
  const auto now = report();
  if (now.health == name_of(SensorHealth::State::streaming)) return now.views.reason;
  return "the sensor is " + now.health + (now.reason.empty() ? "" : ": " + now.reason);
}

double LiveSensor::frame_rate_hz(Clock::time_point now) const {
  const auto first = std::find_if(arrivals_.begin(), arrivals_.end(),
                                  [&](Clock::time_point arrival) { return now - arrival < kRateWindow; });
  if (std::distance(first, arrivals_.end()) < 2) return 0;
  const std::chrono::duration<double> span = arrivals_.back() - *first;
  return span.count() > 0 ? static_cast<double>(std::distance(first, arrivals_.end()) - 1) / span.count() : 0;
}

}  // namespace calibrd
