// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "drivers/robot/motion/motion_error.hpp"
#include "drivers/robot/motion/motion_machine.hpp"

/// The commands of a motion: which goes out, and what its answer leads to.
namespace calibrd {
namespace {

constexpr std::int32_t kPointCommand = simple_message::JointTrajectoryPointFull::kType;
constexpr std::chrono::milliseconds kBusyPause{20};

std::string joints_in_words(const std::vector<double>& positions_rad) {
  std::string text;
  char number[32];
  for (const double q : positions_rad) {
    std::snprintf(number, sizeof number, "%s%.4f", text.empty() ? "" : " ", q);
    text += number;
  }
  return text;
}

std::string point_in_words(int index, const JointMove& move, std::size_t posture, std::size_t postures) {
  const auto point = move.point(index);
  char head[96];
  std::snprintf(head, sizeof head,
                "trajectory point %d of %d, %.1f s of %.1f s, to posture %zu of %zu: joints ", index + 1,
                move.point_count(), point.time_s, move.duration_s(), posture, postures);
  return head + joints_in_words(point.positions_rad) + " rad";
}

}  // namespace

void MotionMachine::send(MotionCommand command, const std::string& why, Clock::duration patience,
                         Clock::time_point now) {
  const std::int32_t sequence = ++sequence_;
  unanswered_.push_back({static_cast<std::int32_t>(command), sequence});
  answer_due_ = now + patience;
  steps_.push_back(motion_step::Send{codec_.control(command, sequence), in_words(command) + ", " + why});
}

void MotionMachine::send_point(Clock::time_point now) {
  const auto& move = path_->move();
  unanswered_.push_back({kPointCommand, next_point_});
  answer_due_ = now + settings_.reply_timeout;
  retry_at_.reset();
  steps_.push_back(
      motion_step::Send{codec_.point(next_point_, move.point(next_point_)),
                        point_in_words(next_point_, move, reached_ + 1, order_.postures_rad.size()) +
                            (busy_since_ ? ", again" : "")});
}

/// Answers come in the order of the requests; one that fits none of them is a doubt.
void MotionMachine::take(const MotionAnswer& answer, Clock::time_point now) {
  if (phase_ == Phase::ended) return;
  const bool fits = !unanswered_.empty() && unanswered_.front().command == answer.command &&
                    unanswered_.front().sequence == answer.sequence;
  if (!fits) {
    if (is_stopping()) return end();
    return give_up({MotionError::reply_unreadable, "an answer to nothing that was asked"}, now);
  }
  unanswered_.pop_front();
  const bool is_last = unanswered_.empty();
  if (!is_last) return;  // a stop has gone out since: only its own answer counts
  answer_due_.reset();
  if (is_stopping()) return go_on_stopping(answer, now);
  obey(answer, now);
}

void MotionMachine::obey(const MotionAnswer& answer, Clock::time_point now) {
  if (phase_ == Phase::moving) return take_point_answer(answer, now);
  const std::string command = in_words(static_cast<MotionCommand>(answer.command));
  if (answer.result != MotionResult::success)
    return give_up({MotionError::refused_by_controller, command + ": " + in_words(answer)}, now);
  if (phase_ == Phase::checking) {
    phase_ = Phase::starting;
    send(MotionCommand::start_trajectory_mode, "the controller is ready", settings_.mode_timeout, now);
  } else if (phase_ == Phase::starting) {
    begin_move(now);
  }
}

void MotionMachine::begin_move(Clock::time_point now) {
  phase_ = Phase::moving;
  next_point_ = 0;
  path_.emplace(JointMove(watch_.joints()->positions_rad, order_.postures_rad[reached_], settings_.limits));
  send_point(now);
}

/// The robot moves from the moment the second point is taken: the first only says where it is.
void MotionMachine::take_point_answer(const MotionAnswer& answer, Clock::time_point now) {
  if (answer.result == MotionResult::busy) {
    if (!busy_since_) busy_since_ = now;
    if (now - *busy_since_ > settings_.reply_timeout) return give_up({MotionError::busy_too_long, {}}, now);
    retry_at_ = now + kBusyPause;
    return;
  }
  if (answer.result != MotionResult::success)
    return give_up({MotionError::refused_by_controller, "trajectory point: " + in_words(answer)}, now);
  busy_since_.reset();
  if (next_point_ == 1) path_->begin(now);
  ++next_point_;
}

void MotionMachine::go_on_moving(Clock::time_point now) {
  if (!unanswered_.empty() || (retry_at_ && now < *retry_at_)) return;
  const auto& move = path_->move();
  const double elapsed_s = path_->elapsed_s(now);
  if (next_point_ < move.point_count()) {
    const double ahead_s = std::chrono::duration<double>(settings_.ahead).count();
    if (JointMove::kPointInterval_s * next_point_ <= elapsed_s + ahead_s) send_point(now);
  } else if (has_arrived(now)) {
    steps_.push_back(motion_step::Reached{++reached_});
    phase_ = Phase::holding;
    hold_until_ = now + settings_.hold;
  } else if (elapsed_s >
             move.duration_s() + std::chrono::duration<double>(settings_.arrive_timeout).count()) {
    give_up({MotionError::not_arrived, {}}, now);
  }
}

bool MotionMachine::has_arrived(Clock::time_point now) const {
  const auto& move = path_->move();
  return path_->elapsed_s(now) >= move.duration_s() && watch_.stands() &&
         widest_gap(watch_.joints()->positions_rad, move.goal_rad()).rad <= settings_.arrived_rad;
}

void MotionMachine::go_on_holding(Clock::time_point now) {
  if (now < *hold_until_) return;
  if (reached_ == order_.postures_rad.size()) return end();
  if (watch_.stands()) return begin_move(now);
  give_up({MotionError::in_motion, {}}, now);
}

}  // namespace calibrd
