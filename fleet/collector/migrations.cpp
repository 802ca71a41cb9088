// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/collector/migrations.hpp"

#include <array>

namespace calibrd::fleet {
namespace {

// The columns are what is asked for often; the document is what the daemon sent, whole.
constexpr const char* kCalibrations = R"sql(
CREATE TABLE calibrations (
  cell text NOT NULL,
  calibration_id text NOT NULL,
  sensor_id text NOT NULL,
  created_at timestamptz NOT NULL,
  finished_at timestamptz NOT NULL,
  status text NOT NULL,
  verdict text,
  method text NOT NULL,
  sigma_position_m double precision,
  sigma_rotation_rad double precision,
  software_version text,
  document jsonb NOT NULL,
  received_at timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (cell, calibration_id)
);
CREATE INDEX calibrations_by_sensor ON calibrations (cell, sensor_id, finished_at DESC);
CREATE INDEX calibrations_by_time ON calibrations (finished_at DESC);
)sql";

// What a fleet is asked every day: the newest accepted calibration of each sensor.
constexpr const char* kNewestPoses = R"sql(
CREATE VIEW newest_poses AS
SELECT DISTINCT ON (cell, sensor_id) cell, sensor_id, calibration_id, finished_at, sigma_position_m, sigma_rotation_rad,
  document -> 'result' -> 'T_base_sensor' AS t_base_sensor
FROM calibrations WHERE verdict = 'accepted' ORDER BY cell, sensor_id, finished_at DESC;
)sql";

constexpr std::array kSteps{kCalibrations, kNewestPoses};

}  // namespace

std::span<const char* const> migrations() { return kSteps; }

}  // namespace calibrd::fleet
