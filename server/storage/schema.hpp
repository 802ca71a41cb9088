// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

namespace calibrd {

inline constexpr const char* kFirstSchema = R"sql(
CREATE TABLE calibrations (
  number INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  sensor_id TEXT NOT NULL,
  created_ms INTEGER NOT NULL,
  method TEXT NOT NULL,
  postures INTEGER NOT NULL,
  activate INTEGER NOT NULL,
  idempotency_key TEXT,
  fingerprint TEXT NOT NULL
);
CREATE UNIQUE INDEX calibrations_by_key ON calibrations (sensor_id, idempotency_key) WHERE idempotency_key IS NOT NULL;
CREATE INDEX calibrations_by_sensor ON calibrations (sensor_id, number);

CREATE TABLE results (
  calibration_id TEXT PRIMARY KEY REFERENCES calibrations (id),
  finished_ms INTEGER NOT NULL,
  status TEXT NOT NULL,
  message TEXT NOT NULL,
  postures_seen INTEGER NOT NULL,
  result TEXT
);

CREATE TABLE activations (
  number INTEGER PRIMARY KEY AUTOINCREMENT,
  sensor_id TEXT NOT NULL,
  calibration_id TEXT NOT NULL REFERENCES calibrations (id),
  activated_ms INTEGER NOT NULL
);
CREATE INDEX activations_by_sensor ON activations (sensor_id, number);

CREATE TRIGGER calibrations_stay BEFORE UPDATE ON calibrations BEGIN SELECT RAISE(ABORT, 'calibrations are kept'); END;
CREATE TRIGGER calibrations_remain BEFORE DELETE ON calibrations BEGIN SELECT RAISE(ABORT, 'calibrations are kept'); END;
CREATE TRIGGER results_stay BEFORE UPDATE ON results BEGIN SELECT RAISE(ABORT, 'results are kept'); END;
CREATE TRIGGER results_remain BEFORE DELETE ON results BEGIN SELECT RAISE(ABORT, 'results are kept'); END;
CREATE TRIGGER activations_stay BEFORE UPDATE ON activations BEGIN SELECT RAISE(ABORT, 'activations are kept'); END;
CREATE TRIGGER activations_remain BEFORE DELETE ON activations BEGIN SELECT RAISE(ABORT, 'activations are kept'); END;
)sql";

/// What an activated pose was found with, and which activations have drifted since.
inline constexpr const char* kPoseBasisAndDrift = R"sql(
ALTER TABLE activations ADD COLUMN basis TEXT NOT NULL DEFAULT '';
CREATE TABLE drifts (
  activation INTEGER PRIMARY KEY REFERENCES activations (number),
  found_ms INTEGER NOT NULL
);
CREATE TRIGGER drifts_stay BEFORE UPDATE ON drifts BEGIN SELECT RAISE(ABORT, 'drifts are kept'); END;
CREATE TRIGGER drifts_remain BEFORE DELETE ON drifts BEGIN SELECT RAISE(ABORT, 'drifts are kept'); END;
)sql";

/// What a sensor saw around the robot when its pose was found: see background_text.hpp.
inline constexpr const char* kBackgrounds = R"sql(
CREATE TABLE backgrounds (
  calibration_id TEXT PRIMARY KEY REFERENCES calibrations (id),
  depths TEXT NOT NULL
);
CREATE TRIGGER backgrounds_stay BEFORE UPDATE ON backgrounds BEGIN SELECT RAISE(ABORT, 'backgrounds are kept'); END;
CREATE TRIGGER backgrounds_remain BEFORE DELETE ON backgrounds BEGIN SELECT RAISE(ABORT, 'backgrounds are kept'); END;
)sql";

/// What a calibration was made from and with: see api::Evidence. `views`: JSON.
inline constexpr const char* kEvidence = R"sql(
CREATE TABLE evidence (
  calibration_id TEXT PRIMARY KEY REFERENCES calibrations (id),
  software_version TEXT NOT NULL,
  configuration TEXT NOT NULL,
  views TEXT NOT NULL
);
CREATE TRIGGER evidence_stays BEFORE UPDATE ON evidence BEGIN SELECT RAISE(ABORT, 'evidence is kept'); END;
CREATE TRIGGER evidence_remains BEFORE DELETE ON evidence BEGIN SELECT RAISE(ABORT, 'evidence is kept'); END;
)sql";

/// A megabyte each, and only of use to a pose that is chosen again: those with 200 newer ones may go.
inline constexpr const char* kOldBackgroundsMayGo = R"sql(
DROP TRIGGER backgrounds_remain;
CREATE TRIGGER backgrounds_remain BEFORE DELETE ON backgrounds
WHEN (SELECT COUNT(*) FROM calibrations old JOIN calibrations newer ON newer.sensor_id = old.sensor_id AND newer.number > old.number
      JOIN backgrounds kept ON kept.calibration_id = newer.id WHERE old.id = OLD.calibration_id) < 200
BEGIN SELECT RAISE(ABORT, 'backgrounds are kept'); END;
)sql";

/// What ended and was not yet acknowledged by a collector (docs/fleet.md): by a trigger, so that it is in here in the same
/// stroke as the result is stored. Of the two only this table may lose rows.
inline constexpr const char* kOutbox = R"sql(
CREATE TABLE outbox (
  number INTEGER PRIMARY KEY AUTOINCREMENT,
  calibration_id TEXT NOT NULL UNIQUE REFERENCES calibrations (id)
);
INSERT INTO outbox (calibration_id) SELECT r.calibration_id FROM results r JOIN calibrations c ON c.id = r.calibration_id ORDER BY c.number;
CREATE TRIGGER results_go_out AFTER INSERT ON results BEGIN INSERT INTO outbox (calibration_id) VALUES (NEW.calibration_id); END;
)sql";

/// Steps from an empty file to today's schema. The file's user_version is how many it has taken; a change is
/// one more step, and the steps before it stay as they are.
inline constexpr std::array kSchemaSteps{kFirstSchema, kPoseBasisAndDrift, kBackgrounds, kEvidence,
                                         kOldBackgroundsMayGo, kOutbox};

}  // namespace calibrd
