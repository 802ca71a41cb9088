// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/control/control_routes.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/core/robot/scratch_folder.hpp"
#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim {
namespace {

namespace json = boost::json;

/// The control calls on a demo cell, without sockets.
class Control : public testing::Test {
 protected:
  static constexpr const char* kCell =
      R"(, "objects": [{"name": "crate", "box_m": [0.2, 0.2, 0.2], "position_m": [0.9, 0, 0.1]}],
         "sensors": [{"id": "eye", "position_m": [1.3, 0.2, 0.7], "target_m": [0, 0, 0.4]}])";

  Control() : world_(*LiveWorld::open(test::world_from(kCell), folder_.path() / "world")) {
    EXPECT_TRUE(controller_.listen(0));
  }

  ControlResponse call(const std::string& method, const std::string& target, const std::string& body = "") {
    return routes_.handle({method, target, body});
  }
  json::value accepted(const std::string& method, const std::string& target, const std::string& body = "") {
    const ControlResponse response = call(method, target, body);
    EXPECT_EQ(response.status, 200U) << response.body;
    return json::parse(response.body);
  }
  /// The message of a refused call.
  std::string refused(unsigned status, const std::string& method, const std::string& target,
                      const std::string& body = "") {
    const ControlResponse response = call(method, target, body);
    EXPECT_EQ(response.status, status) << response.body;
    return std::string(json::parse(response.body).at("message").as_string());
  }
  json::value truth() { return accepted("GET", "/truth"); }
  json::value sensor() { return truth().at("sensors").at(0); }

  calibrd::test::ScratchFolder folder_;
  LiveWorld world_;
  boost::asio::io_context io_;
  ControllerServer controller_{io_, [this]() -> const WorldState& { return world_.state(); }, {}};
  ControlRoutes routes_{world_, controller_};
};

TEST_F(Control, TruthNamesJointsSensorsObjectsAndController) {
  const json::value truth = this->truth();
  EXPECT_EQ(truth.at("joint_names").as_array().size(), 7U);
  EXPECT_EQ(truth.at("base_link").as_string(), "base_link");
  EXPECT_EQ(truth.at("sensors").at(0).at("id").as_string(), "eye");
  EXPECT_EQ(truth.at("objects").at(0).at("name").as_string(), "crate");
  EXPECT_EQ(truth.at("controller").at("byte_order").as_string(), "big");
  EXPECT_EQ(truth.at("controller").at("port").to_number<int>(), controller_.port());
}

TEST_F(Control, TruthOfAnotherMomentFollowsTheMotion) {
  accepted("PUT", "/motion", R"({"mode": "jog", "joint": "joint_l", "speed_rad_s": 0.5})");
  const std::int64_t later = monotonic_ns() + 2'000'000'000;
  const json::value truth = accepted("GET", "/truth?at_ns=" + std::to_string(later));
  EXPECT_EQ(truth.at("time_ns").to_number<std::int64_t>(), later);
  EXPECT_EQ(truth.at("joints_rad").at(1).to_number<double>(), world_.state().motion.positions_at(later)[1]);
  EXPECT_NE(truth.at("joints_rad").at(1).to_number<double>(), 0);
  refused(400, "GET", "/truth?at=5");
  refused(400, "GET", "/truth?at_ns=soon");
}

TEST_F(Control, PoseIsSetAndReachesTheSharedWorld) {
  accepted("PUT", "/sensors/eye/pose", R"({"T_base_sensor": [[0,0,1,0.5],[-1,0,0,0.25],[0,-1,0,1]]})");
  const auto view = WorldView::open(folder_.path() / "world");
  ASSERT_TRUE(view);
  const Eigen::Isometry3d pose = view->read()->sensors[0].T_base_sensor.pose();
  EXPECT_EQ(pose.translation(), Eigen::Vector3d(0.5, 0.25, 1));
  EXPECT_TRUE(pose.linear().col(2).isApprox(Eigen::Vector3d::UnitX()));
}

TEST_F(Control, KnockTurnsAboutTheSensorAndShiftsInBaseAxes) {
  const Eigen::Isometry3d before = world_.state().sensors[0].T_base_sensor.pose();
  accepted("POST", "/sensors/eye/knock", R"({"turn_deg": [0, 0, 90], "shift_m": [0.01, -0.02, 0.03]})");
  const Eigen::Isometry3d after = world_.state().sensors[0].T_base_sensor.pose();
  const Eigen::Matrix3d quarter =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_TRUE(after.linear().isApprox(quarter * before.linear(), 1e-12));
  EXPECT_TRUE(
      (after.translation() - before.translation()).isApprox(Eigen::Vector3d(0.01, -0.02, 0.03), 1e-9));
}

TEST_F(Control, ErrorsAreSetOneByOneAndByPreset) {
  accepted("PUT", "/sensors/eye/errors",
           R"({"depth": {"preset": "kinect2", "offset_m": 0.012}, "latency_s": 0.05})");
  EXPECT_EQ(sensor().at("depth_errors").at("offset_m").to_number<double>(), 0.012);
  EXPECT_EQ(sensor().at("depth_errors").at("noise").to_number<double>(), 1);
  EXPECT_EQ(sensor().at("latency_s").to_number<double>(), 0.05);
  accepted("PUT", "/sensors/eye/errors", R"({"depth": {"noise": 0}, "infrared": {"noise": 2}})");
  EXPECT_EQ(sensor().at("depth_errors").at("noise").to_number<double>(), 0);
  EXPECT_EQ(sensor().at("depth_errors").at("offset_m").to_number<double>(), 0.012);
  EXPECT_EQ(sensor().at("infrared").at("noise").to_number<double>(), 2);
}

TEST_F(Control, ModesAndCrashesOfTheSensor) {
  for (const char* mode : {"silent", "hanging", "unplugged", "normal"}) {
    accepted("PUT", "/sensors/eye/mode", std::string(R"({"mode": ")") + mode + "\"}");
    EXPECT_EQ(sensor().at("mode").as_string(), mode);
  }
  accepted("POST", "/sensors/eye/crash");
  EXPECT_EQ(sensor().at("crashes").to_number<int>(), 1);
}

TEST_F(Control, MotionRunsHoldsAndVisits) {
  accepted("PUT", "/motion", R"({"mode": "run", "seed": 3, "count": 5, "speed_rad_s": 0.4})");
  EXPECT_EQ(world_.state().motion.next.program.posture_count, 6);
  accepted("PUT", "/motion", R"({"mode": "postures", "postures_rad": [[0.1,0.2,0.3,0.4,0.5,0.6,0.7]]})");
  EXPECT_NEAR(world_.state().motion.positions_at(monotonic_ns() + 60'000'000'000)[6], 0.7, 1e-12);
  accepted("PUT", "/motion", R"({"mode": "hold"})");
  const std::int64_t stopped = monotonic_ns() + 5'000'000'000;
  EXPECT_EQ(world_.state().motion.positions_at(stopped), world_.state().motion.positions_at(2 * stopped));
}

TEST_F(Control, JointZerosShowInWhatIsReported) {
  accepted("PUT", "/joint-zeros", R"({"joint_zero_rad": [0.01, 0, 0, 0, 0, 0, 0]})");
  EXPECT_NEAR(truth().at("joints_rad").at(0).to_number<double>() -
                  truth().at("joints_reported_rad").at(0).to_number<double>(),
              0.01, 1e-12);
}

TEST_F(Control, ControllerTakesTheMannersOfOtherMakes) {
  accepted("PUT", "/controller", R"({"protocol": "rtde", "rtde_protocol": 1, "rtde_missing": "actual_qd"})");
  EXPECT_EQ(truth().at("controller").at("protocol").as_string(), "rtde");
  EXPECT_EQ(controller_.settings().rtde_protocol, 1);
  EXPECT_EQ(controller_.settings().rtde_missing, "actual_qd");
  accepted(
      "PUT", "/controller",
      R"({"protocol": "joint_position", "status_every": 11, "send_bytes": 4, "j3_from_horizontal": true})");
  EXPECT_EQ(controller_.settings().protocol, ControllerSettings::Protocol::joint_position);
  EXPECT_EQ(controller_.settings().status_every, 11);
  EXPECT_EQ(controller_.settings().send_bytes, 4);
  EXPECT_EQ(truth().at("controller").at("j3_from_horizontal").as_bool(), true);
}

TEST_F(Control, ControllerIsSetAndItsClientsDropped) {
  accepted("PUT", "/controller", R"({"mode": "frozen", "byte_order": "little", "latency_s": 0.2})");
  EXPECT_EQ(truth().at("controller").at("mode").as_string(), "frozen");
  EXPECT_EQ(controller_.settings().big_endian, 0);
  EXPECT_EQ(accepted("POST", "/controller/drop", R"({"how": "reset"})").at("dropped").to_number<int>(), 0);
}

TEST_F(Control, ObjectsPeopleAndTheOtherRobotComeAndGo) {
  accepted("PUT", "/objects/crate", R"({"shift_m": [0.1, 0, 0]})");
  EXPECT_NEAR(world_.state().objects[0].T_base_object.pose().translation().x(), 1.0, 1e-12);
  accepted("PUT", "/objects/crate", R"({"present": false})");
  EXPECT_EQ(world_.state().objects[0].present, 0);
  accepted("PUT", "/person", R"({"present": true, "from_m": [1, 1], "to_m": [1, -1]})");
  EXPECT_EQ(world_.state().person.present, 1);
  accepted("PUT", "/other-robot",
           R"({"present": true, "position_m": [0, 1.5, 0], "posture_rad": [0,1,0,0,0,0,0]})");
  EXPECT_EQ(world_.state().other_robot.joints[1], 1.0);
}

TEST_F(Control, RefusalsSayWhatIsWrong) {
  EXPECT_NE(refused(400, "PUT", "/motion", "{").find("not JSON"), std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/motion", "[]").find("JSON object"), std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/motion", "{}").find("mode"), std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/motion", R"({"mode": "jog", "joint": "knee"})").find("knee"),
            std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/sensors/eye/errors", R"({"depth": {"nois": 1}})").find("depth.nois"),
            std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/sensors/eye/errors", R"({"depth": {"scale": 7}})").find("from 0.5"),
            std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/sensors/eye/pose", R"({"T_base_sensor": [1, 2]})").find("4x4"),
            std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/sensors/eye/pose", R"({"T_base_sensor": [2,0,0,0, 0,1,0,0, 0,0,1,0]})")
                .find("rotation"),
            std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/joint-zeros", R"({"joint_zero_rad": [1, 2]})").find("7 numbers"),
            std::string::npos);
  EXPECT_NE(refused(400, "PUT", "/sensors/eye/mode", "{}").find("mode"), std::string::npos);
  EXPECT_NE(refused(404, "PUT", "/sensors/nose/pose", "{}").find("nose"), std::string::npos);
  EXPECT_NE(refused(404, "PUT", "/objects/piano", "{}").find("piano"), std::string::npos);
  refused(404, "GET", "/");
  refused(404, "PUT", "/sensors/eye/colour", "{}");
  refused(405, "POST", "/truth");
  refused(405, "GET", "/motion");
  refused(405, "PUT", "/sensors/eye/knock", "{}");
}

TEST_F(Control, ARefusedCallChangesNothing) {
  const WorldState before = world_.state();
  refused(400, "PUT", "/objects/crate", R"({"shift_m": [1, 0, 0], "presnt": true})");
  refused(400, "PUT", "/sensors/eye/errors", R"({"depth": {"offset_m": 0.5}, "latency_s": -1})");
  EXPECT_EQ(world_.state().objects[0], before.objects[0]);
  EXPECT_EQ(world_.state().sensors[0].depth, before.sensors[0].depth);
}

}  // namespace
}  // namespace calibrd::sim
