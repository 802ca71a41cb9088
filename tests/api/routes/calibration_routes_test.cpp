// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

constexpr const char* kStart = "/api/v1/sensors/kinect2/calibrations";

class CalibrationRoutes : public RouteTest {
 protected:
  void SetUp() override {
    cell_.on_start = [this](const CalibrationRequest& request) -> Result<CalibrationReport> {
      wanted_ = request;
      return cell_.calibration_report;
    };
  }
  CalibrationRequest wanted_;
};

TEST_F(CalibrationRoutes, StartIsAcceptedWithALocation) {
  EXPECT_EQ(ask("POST", kStart).status, 202);
  EXPECT_EQ(header("Location"), "/api/v1/calibrations/c1");
  EXPECT_EQ(body().at("status"), "queued");
  EXPECT_TRUE(wanted_.activate);
  EXPECT_FALSE(wanted_.postures);
  EXPECT_EQ(wanted_.method, Method::full);
}

TEST_F(CalibrationRoutes, EveryKeyOfTheBodyIsTaken) {
  EXPECT_EQ(ask("POST", kStart,
                R"({"method": "paper", "guess": [1,2,3,0,0,0,1], "postures": 3, "activate": false})",
                {{"idempotency-key", "k1"}})
                .status,
            202);
  EXPECT_EQ(wanted_.method, Method::paper);
  EXPECT_EQ(wanted_.postures, 3);
  EXPECT_FALSE(wanted_.activate);
  EXPECT_EQ(wanted_.idempotency_key, "k1");
  ASSERT_TRUE(wanted_.guess_T_base_sensor);
  EXPECT_DOUBLE_EQ(wanted_.guess_T_base_sensor->translation().y(), 2);
}

TEST_F(CalibrationRoutes, NullAsGuessAsksForASearchFromNothing) {
  EXPECT_EQ(ask("POST", kStart, R"({"guess": null})").status, 202);
  EXPECT_TRUE(wanted_.from_nothing);
  EXPECT_EQ(ask("POST", kStart, "{}").status, 202);
  EXPECT_FALSE(wanted_.from_nothing);
  EXPECT_EQ(ask("POST", kStart, R"({"guess": [1,2,3,0,0,0,1]})").status, 202);
  EXPECT_FALSE(wanted_.from_nothing);
}

TEST_F(CalibrationRoutes, GuessMayBeWhatThePoseRouteGave) {
  cell_.make_calibrated();
  const auto pose = get("/api/v1/sensors/kinect2/pose");
  EXPECT_EQ(ask("POST", kStart, "{\"guess\": " + pose.body + "}").status, 202);
  ASSERT_TRUE(wanted_.guess_T_base_sensor);
}

TEST_F(CalibrationRoutes, BadBodiesAreRefusedBeforeAnythingStarts) {
  cell_.on_start = [](const CalibrationRequest&) -> Result<CalibrationReport> {
    throw std::logic_error("started");
  };
  const auto refused = [&](const std::string& sent, const std::string& wanted_code) {
    EXPECT_EQ(ask("POST", kStart, sent).status, 400) << sent;
    EXPECT_EQ(code(), wanted_code) << sent;
    EXPECT_FALSE(body().at("remedy").as_string().empty());
  };
  refused("{", "bad_json");
  refused("[1]", "bad_json");
  refused(R"({"posture": 3})", "unknown_key");
  refused(R"({"postures": 0})", "bad_value");
  refused(R"({"postures": 1.5})", "bad_value");
  refused(R"({"method": "fast"})", "bad_value");
  refused(R"({"activate": "yes"})", "bad_value");
  refused(R"({"guess": [1, 2]})", "bad_value");
  refused(R"({"guess": "1,2,3"})", "bad_value");
  refused(R"({"guess": [1370, 730, 860, 0, 0, 0, 1]})", "bad_value");
  refused(R"({"guess": {"T_base_sensor": [1.3, 0.7, 0.8, 0, 0, 0, 1], "unit": "mm"}})", "bad_value");
}

TEST_F(CalibrationRoutes, QuaternionOfAGuessMayHaveAnyLength) {
  EXPECT_EQ(ask("POST", kStart, R"({"guess": [1, 2, 3, 0, 0, 0.7, 0.7]})").status, 202);
}

TEST_F(CalibrationRoutes, BodyThatIsNotCalledJsonIs415) {
  EXPECT_EQ(ask("POST", kStart, "{}", {{"content-type", "application/x-www-form-urlencoded"}}).status, 415);
}

TEST_F(CalibrationRoutes, IdempotencyKeyMustBePrintable) {
  EXPECT_EQ(ask("POST", kStart, "", {{"idempotency-key", "a b"}}).status, 400);
  EXPECT_EQ(ask("POST", kStart, "", {{"idempotency-key", ""}}).status, 400);
  EXPECT_EQ(ask("POST", kStart, "", {{"idempotency-key", std::string(129, 'k')}}).status, 400);
}

TEST_F(CalibrationRoutes, ServicesReasonsBecomeProblems) {
  cell_.on_start = [](const CalibrationRequest&) -> Result<CalibrationReport> {
    return fail(ApiError::calibration_in_progress, "c0");
  };
  EXPECT_EQ(ask("POST", kStart).status, 409);
  EXPECT_EQ(code(), "calibration_in_progress");
  EXPECT_EQ(header("Content-Type"), "application/problem+json");
}

TEST_F(CalibrationRoutes, JobIsShownWithVerdictAndResult) {
  cell_.calibration_report.status = JobStatus::failed;
  cell_.calibration_report.result = CalibrationResult{};
  EXPECT_EQ(get("/api/v1/calibrations/c1").status, 200);
  EXPECT_EQ(body().at("status"), "failed");
  EXPECT_EQ(body().at("verdict"), "rejected");
  EXPECT_FALSE(body().at("result").as_object().contains("T_base_sensor"));
  EXPECT_EQ(get("/api/v1/calibrations/c9").status, 404);
}

TEST_F(CalibrationRoutes, DeleteCancelsAndActivateActivates) {
  EXPECT_EQ(ask("DELETE", "/api/v1/calibrations/c1").status, 200);
  EXPECT_EQ(cell_.cancelled, "c1");
  EXPECT_EQ(ask("POST", "/api/v1/calibrations/c1/activate").status, 200);
  EXPECT_EQ(cell_.activated, "c1");
}

TEST_F(CalibrationRoutes, UnknownParametersAreRefusedEverywhere) {
  for (const auto* path : {"/livez", "/readyz", "/api/v1/calibrations/c1", kStart}) {
    EXPECT_EQ(get(std::string(path) + "?bogus").status, 400) << path;
    EXPECT_EQ(code(), "bad_query") << path;
  }
  EXPECT_EQ(ask("DELETE", "/api/v1/calibrations/c1?bogus").status, 400);
  EXPECT_EQ(cell_.cancelled, "");
  EXPECT_EQ(ask("POST", "/api/v1/calibrations/c1/activate?bogus").status, 400);
  EXPECT_EQ(cell_.activated, "");
}

TEST_F(CalibrationRoutes, HistoryIsPaged) {
  EXPECT_EQ(get(std::string(kStart) + "?limit=1&before=c7").status, 200);
  EXPECT_EQ(cell_.last_history.limit, 1);
  EXPECT_EQ(cell_.last_history.before, "c7");
  EXPECT_EQ(body().at("next"), "/api/v1/sensors/kinect2/calibrations?limit=1&before=c1");
  EXPECT_FALSE(body().at("calibrations").at(0).as_object().contains("result"));
  EXPECT_EQ(get(std::string(kStart) + "?limit=0").status, 400);
  EXPECT_EQ(get(std::string(kStart) + "?limit=ten").status, 400);
}

}  // namespace
}  // namespace calibrd::api
