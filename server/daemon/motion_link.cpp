// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/motion_link.hpp"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <thread>

#include "server/config/config_error.hpp"
#include "server/daemon/conversions.hpp"

namespace calibrd {

namespace asio = boost::asio;

namespace {

constexpr std::chrono::milliseconds kFarewell{500};
constexpr std::chrono::milliseconds kPause{5};

Error at(const std::string& key, const std::string& why) {
  return {ConfigError::bad_value, key + ": " + why};
}

Status check_postures(const std::string& route, const MotionRouteConfig& config, const RobotModel& model) {
  const std::string key = "motion.routes." + route + ".postures_deg";
  for (const auto& posture : config.postures_deg)
    if (posture.size() != model.position_count())
      return at(key, "a posture has " + std::to_string(posture.size()) + " positions, the robot " +
                         std::to_string(model.position_count()) + " joints");
  return Done{};
}

}  // namespace

struct MotionLink::Thread {
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  std::thread thread;

  /// What asio itself fails at ends the motion, not the thread.
  void run(MotionClient& client) {
    for (;;) {
      try {
        io.run();
        return;
      } catch (const std::exception&) {
        client.stop(MotionError::short_of_resources);
      }
    }
  }
};

MotionLink::MotionLink(const MotionClientSettings& settings)
    : thread_(std::make_unique<Thread>()),
      client_(std::make_shared<MotionClient>(thread_->io.get_executor(), settings)) {
  thread_->thread = std::thread([thread = thread_.get(), client = client_] { thread->run(*client); });
}

MotionLink::~MotionLink() { stop(); }

RobotLinkEvents MotionLink::heard(RobotLinkEvents events) {
  const auto too = [](auto inner, const std::shared_ptr<MotionClient>& client) {
    return [inner = std::move(inner), client](const auto& told) {
      client->take(told);
      if (inner) inner(told);
    };
  };
  events.on_joints = too(std::move(events.on_joints), client_);
  events.on_status = too(std::move(events.on_status), client_);
  events.on_health = too(std::move(events.on_health), client_);
  return events;
}

void MotionLink::stop() {
  if (!thread_->thread.joinable()) return;
  client_->stop(MotionError::daemon_ends);
  for (const auto end = Clock::now() + kFarewell; client_->is_busy() && Clock::now() < end;)
    std::this_thread::sleep_for(kPause);
  client_->shut_down();
  thread_->work.reset();
  thread_->io.stop();
  thread_->thread.join();
}

Status check_motion(const Config& config, const RobotModel& model, const JointMapping& mapping) {
  for (const auto& [name, route] : config.motion.routes)
    if (auto status = check_postures(name, route, model); !status) return status;
  if (!config.motion.enabled) return Done{};
  if (config.robot.driver != "simple_message")
    return at("motion.enabled",
              "robot.driver = \"" + config.robot.driver + "\": only MotoROS has the motion port");
  for (const auto& joint : model.joints())
    if (joint.position_index >= 0 && joint.type == JointType::prismatic)
      return at("motion.enabled", joint.name + " slides, and only robots whose joints all turn can be moved");
  const auto values =
      mapping.controller_values(std::vector<double>(model.position_count()),
                                std::vector<double>(static_cast<std::size_t>(config.robot.joint_count)));
  if (!values) return Error{values.error().code, "motion.enabled: " + values.error().detail};
  return check(motion_client_settings(config));
}

}  // namespace calibrd
