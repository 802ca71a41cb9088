// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "api/service/cell_service.hpp"
#include "fleet/exporter/export_window.hpp"
#include "fleet/exporter/exporter_watch.hpp"
#include "fleet/exporter/name_guard.hpp"
#include "fleet/exporter/outbox.hpp"
#include "fleet/exporter/state_publisher.hpp"
#include "fleet/messages/acknowledgement.hpp"
#include "fleet/messages/topics.hpp"
#include "fleet/mqtt/mqtt_client.hpp"

namespace calibrd::fleet {

struct ExporterSettings {
  MqttSettings broker;  ///< without client_id and last will: the exporter's own affair
  std::string prefix = "calibrd";
  std::string cell;
  std::string version;
};

/// One line for the log; false: something is wrong.
using ExporterLog = std::function<void(const std::string& line, bool is_well)>;

/// Tells a broker how the cell is, and every calibration until a collector has acknowledged it. All of it on
/// a thread of its own, with bounded memory: a broker that is slow or gone costs the cell nothing but rows in
/// the outbox.
class Exporter {
 public:
  /// `service`, `outbox` and `watch` must outlive it. Errors: MqttError. A broker that is not there is none.
  static Result<std::unique_ptr<Exporter>> start(const ExporterSettings& settings,
                                                 const api::CellService& service, Outbox& outbox,
                                                 ExporterLog log, ExporterWatch& watch);
  ~Exporter();

  /// There may be something new in the outbox. Safe to call from any thread; never waits.
  void wake();

 private:
  struct Message {
    std::string topic, payload;
  };

  Exporter(const ExporterSettings& settings, const api::CellService& service, Outbox& outbox, ExporterLog log,
           ExporterWatch& watch);
  MqttEvents events();
  void run();
  void look();
  void greet();
  void hear(const Message& message);
  void hear_status(const std::string& status);
  void note(const Acknowledgement& acknowledgement);
  void refill();
  void send_due();
  void count_waiting();
  bool publish(const std::string& topic, const std::string& payload, bool retain,
               std::optional<std::chrono::seconds> expiry = {});
  void end();

  const ExporterSettings settings_;
  const CellTopics topics_;
  Outbox& outbox_;
  const ExporterLog log_;
  ExporterWatch& watch_;

  // The thread's own.
  ExportWindow window_;
  NameGuard guard_;
  const Teller teller_;
  StatePublisher states_;
  std::string outbox_trouble_;
  std::chrono::steady_clock::time_point next_count_{};

  std::mutex mutex_;  // guards what follows
  std::condition_variable change_;
  std::deque<Message> heard_;
  bool is_connected_ = false, is_new_connection_ = false, is_woken_ = false, is_ending_ = false;
  int in_flight_ = 0;  // messages the broker has not taken yet
  std::string trouble_;

  std::unique_ptr<MqttClient> client_;
  std::thread thread_;
};

}  // namespace calibrd::fleet
