// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/robot_motions.hpp"

#include <algorithm>
#include <cmath>

#include "api/problem/api_error.hpp"
#include "core/planning/posture_way.hpp"
#include "server/live_cell/dated_id.hpp"

namespace calibrd {

using api::ApiError;
using api::MotionReport;
using api::MotionStatus;

namespace {

constexpr std::size_t kRemembered = 50;
constexpr double kSame_rad = 1e-6;  // what JSON may cost

bool is_same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) { return std::abs(x - y) <= kSame_rad; });
}

bool is_under_way(const MotionReport& report) { return !report.finished; }

MotionStatus status_of(const MotionEnd& how) {
  if (!how.error) return MotionStatus::succeeded;
  const auto& code = how.error->code;
  const bool was_asked_for = code == MotionError::stop_requested || code == MotionError::daemon_ends;
  return was_asked_for ? MotionStatus::stopped : MotionStatus::failed;
}

}  // namespace

void RobotMotions::set_mover(RobotMover* mover) {
  const std::lock_guard lock(mutex_);
  mover_ = mover;
}

void RobotMotions::remember(const std::string& sensor_id, const PostureSuggestion& suggestion) {
  const std::lock_guard lock(mutex_);
  suggested_rad_[sensor_id] = suggestion.positions_rad;
}

Result<MotionReport> RobotMotions::start(const api::MotionRequest& request) {
  const std::lock_guard starting(starting_);
  RobotMover* mover = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (is_stopping_) return fail(ApiError::shutting_down);
    mover = mover_;
  }
  if (!settings_.enabled || mover == nullptr) return fail(ApiError::motion_disabled);
  if (const auto busy = active(); !busy.empty()) return fail(ApiError::motion_in_progress, busy);
  const auto postures = wanted(request);
  if (!postures) return postures.error();
  if (const auto doubt = mover->doubt()) return fail(ApiError::motion_not_possible, doubt->message());
  auto order = make_order(*postures);
  if (!order) return order.error();
  const auto id = add_report(request, postures->size());
  if (const auto begun = mover->start(*std::move(order), events_of(id)); !begun) end(id, {begun.error()});
  const auto report = find(id);
  if (report->status == MotionStatus::failed) return fail(ApiError::motion_not_possible, report->message);
  return report;
}

Result<RobotMotions::Postures> RobotMotions::wanted(const api::MotionRequest& request) const {
  if (request.next_posture_of.empty()) {
    const auto route = settings_.routes_rad.find(request.route);
    if (route == settings_.routes_rad.end()) return fail(ApiError::no_such_motion_route, request.route);
    return route->second;
  }
  const std::lock_guard lock(mutex_);
  const auto suggested = suggested_rad_.find(request.next_posture_of);
  if (suggested == suggested_rad_.end() || !is_same(suggested->second, request.approved_rad))
    return fail(ApiError::posture_not_suggested, request.next_posture_of);
  return Postures{suggested->second};
}

/// From where the robot is now, checked against the model, in the controller's terms.
Result<MotionOrder> RobotMotions::make_order(const Postures& postures) const {
  const auto joints = robot_.newest_joints();
  if (!joints) return fail(ApiError::no_joints);
  if (robot_.is_stale(*joints)) return fail(ApiError::joints_stale);
  WaySettings way;
  way.min_height_m = settings_.table_height_m;
  if (const auto against = way_objection(robot_.model(), joints->positions_rad, postures, way))
    return fail(ApiError::way_refused, *against);
  MotionOrder order;
  const auto from = robot_.controller_values(joints->positions_rad);
  if (!from) return fail(ApiError::motion_not_possible, from.error().message());
  order.from_rad = *from;
  for (const auto& posture : postures) {
    const auto values = robot_.controller_values(posture);
    if (!values) return fail(ApiError::motion_not_possible, values.error().message());
    order.postures_rad.push_back(*values);
  }
  return order;
}

std::string RobotMotions::add_report(const api::MotionRequest& request, std::size_t postures) {
  const std::lock_guard lock(mutex_);
  MotionReport report;
  report.created = std::chrono::system_clock::now();
  report.id = "m" + dated_id(report.created, random_);
  report.route = request.route;
  report.next_posture_of = request.next_posture_of;
  report.postures = static_cast<int>(postures);
  report.message = "on the way to posture 1 of " + std::to_string(postures);
  reports_.push_front(report);
  if (reports_.size() > kRemembered) reports_.pop_back();
  log_("robot motion " + report.id + ": begins, " +
           (request.route.empty()
                ? "to the posture suggested for sensor " + request.next_posture_of + " and approved"
                : "along the route " + request.route),
       true);
  return report.id;
}

MotionEvents RobotMotions::events_of(const std::string& id) {
  MotionEvents events;
  events.on_command = [this, id](const std::string& what) {
    log_("robot motion " + id + ": " + what, true);
    update(id, [](auto& report) { ++report.commands; });
  };
  events.on_reached = [this, id](std::size_t reached) {
    update(id, [reached](auto& report) {
      report.reached = static_cast<int>(reached);
      report.message = "at posture " + std::to_string(reached) + " of " + std::to_string(report.postures);
    });
  };
  events.on_end = [this, id](const MotionEnd& how) { end(id, how); };
  return events;
}

void RobotMotions::update(const std::string& id, const std::function<void(MotionReport&)>& change) {
  const std::lock_guard lock(mutex_);
  const auto report = std::ranges::find(reports_, id, &MotionReport::id);
  if (report != reports_.end()) change(*report);
}

void RobotMotions::end(const std::string& id, const MotionEnd& how) {
  const auto status = status_of(how);
  const auto message = how.error ? how.error->message() : "every posture was visited";
  update(id, [&](auto& report) {
    report.status = status;
    report.message = message;
    report.finished = std::chrono::system_clock::now();
  });
  log_("robot motion " + id + ": ended: " + message, status != MotionStatus::failed);
}

std::string RobotMotions::active() const {
  const std::lock_guard lock(mutex_);
  const auto report = std::ranges::find_if(reports_, is_under_way);
  return report == reports_.end() ? std::string() : report->id;
}

api::MotionsReport RobotMotions::list() const {
  api::MotionsReport report;
  RobotMover* mover = nullptr;
  {
    const std::lock_guard lock(mutex_);
    mover = mover_;
    report.motions.assign(reports_.begin(), reports_.end());
  }
  report.enabled = settings_.enabled && mover != nullptr;
  for (const auto& [name, unused] : settings_.routes_rad) report.routes.push_back(name);
  if (!report.enabled) {
    report.hindrance = fail(ApiError::motion_disabled).message();
    return report;
  }
  const auto doubt = mover->doubt();
  report.hindrance = doubt ? doubt->message() : std::string();
  return report;
}

Result<MotionReport> RobotMotions::find(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  const auto report = std::ranges::find(reports_, id, &MotionReport::id);
  if (report == reports_.end()) return fail(ApiError::no_such_motion, std::string(id));
  return *report;
}

Result<MotionReport> RobotMotions::stop(std::string_view id) {
  RobotMover* mover = nullptr;
  {
    const std::lock_guard lock(mutex_);
    const auto report = std::ranges::find(reports_, id, &MotionReport::id);
    if (report == reports_.end()) return fail(ApiError::no_such_motion, std::string(id));
    if (!is_under_way(*report)) return fail(ApiError::motion_ended, report->message);
    report->status = MotionStatus::stopping;
    mover = mover_;
  }
  mover->stop(MotionError::stop_requested);
  return find(id);
}

void RobotMotions::request_stop() {
  RobotMover* mover = nullptr;
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    mover = mover_;
  }
  if (mover != nullptr) mover->stop(MotionError::daemon_ends);
}

}  // namespace calibrd
