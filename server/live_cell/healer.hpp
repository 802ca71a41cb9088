// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "api/service/reports.hpp"
#include "core/base/result.hpp"
#include "core/sensing/images.hpp"

namespace calibrd {

/// What is done when a sensor has moved.
enum class HealingMode { automatic, ask, off };
const char* name_of(HealingMode mode);

struct HealerSettings {
  HealingMode mode = HealingMode::automatic;
  int postures = 3;                                     ///< of a quick attempt, at most
  api::Seconds patience{1.5};                           ///< how long it collects: see CalibrationRequest
  Clock::duration cooldown = std::chrono::seconds(10);  ///< after a failed attempt; doubles up to ...
  Clock::duration longest_cooldown = std::chrono::minutes(10);
  Clock::duration calm_after = std::chrono::minutes(10);  ///< ... and starts anew after so long without one
  /// A quick result that is less certain is followed by a calibration from all the postures.
  double quick_sigma_m = 0.001, quick_sigma_rad = 0.001;
};

/// Has sensors calibrated again that have moved: at once from the postures at hand; when that fails, once
/// more so; when that fails, too, or tells less than it should, with all the postures a calibration asks for;
/// after failures again, with pauses that grow. A sensor that moves again
/// and again is given pauses, too. Safe to call from any thread.
class Healer {
 public:
  /// Starts a calibration of a sensor; may fail, because one is under way or the cell is stopping.
  using Start = std::function<Result<api::CalibrationReport>(const api::CalibrationRequest&)>;
  /// Ends one that it has started.
  using Cancel = std::function<void(const std::string& calibration_id)>;

  /// When a sensor last moved or was away.
  using LastMove = std::function<Clock::time_point(const std::string& sensor_id)>;

  Healer(const HealerSettings& settings, Start start, Cancel cancel, LastMove last_move);
  ~Healer();

  void on_pose(const api::PoseReport& pose);
  /// Of every calibration that has ended; `seen_at`: when its last view was taken.
  void on_calibration(const api::CalibrationReport& calibration, Clock::time_point seen_at);

  /// Somebody has chosen another pose for the sensor: it is not made better unasked.
  void on_choice(const std::string& sensor_id);

  /// Somebody does not want what waits to be activated: it is sought again after a pause. False: it is no
  /// candidate.
  bool decline(const std::string& calibration_id);

  HealingMode mode() const { return settings_.mode; }
  /// Id of a calibration of the sensor that waits to be activated; empty: none, or it has moved since.
  std::string candidate(const std::string& sensor_id) const;
  /// When it tries again; nothing: it is not waiting to.
  std::optional<Clock::time_point> next_attempt(const std::string& sensor_id) const;

  void request_stop();

 private:
  /// A calibration that it has started: of a sensor that has moved, or to make a quick pose better.
  struct Attempt {
    std::string calibration_id;
    bool refines = false;
  };
  struct Patient {
    bool drifted = false;
    std::string drifted_calibration;  ///< whose pose has drifted
    bool wants_all = false;           ///< its pose is from few postures, and could be better
    std::optional<Attempt> under_way;
    std::string candidate;
    Clock::time_point candidate_seen_at;
    int attempts = 0;  ///< since it drifted
    int moves = 0;     ///< since it was last calm
    Clock::time_point last_move, due;
  };
  void run();
  void begin(const std::string& sensor_id, std::unique_lock<std::mutex>& lock);
  void cancel(Patient& patient, std::unique_lock<std::mutex>& lock);
  api::CalibrationRequest next_request(const std::string& sensor_id) const;
  bool tells_too_little(const Patient& patient, const api::CalibrationReport& calibration) const;
  Clock::duration pause_after(int attempts) const;
  void plan(Patient& patient, Clock::time_point now) const;
  bool has_candidate(const std::string& sensor_id, const Patient& patient) const;

  const HealerSettings settings_;
  const Start start_;
  const Cancel cancel_;
  const LastMove last_move_;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::map<std::string, Patient> patients_;
  bool is_starting_ = false, is_stopping_ = false;
  std::thread thread_;
};

}  // namespace calibrd
