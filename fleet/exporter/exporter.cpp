// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/exporter.hpp"

#include <algorithm>
#include <utility>

#include "core/base/thread_name.hpp"
#include "fleet/exporter/payloads.hpp"

namespace calibrd::fleet {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(200);
constexpr auto kCountPeriod = std::chrono::seconds(5);
constexpr std::size_t kWindow = 32;  // calibrations, some kilobytes each
constexpr std::size_t kMostHeard = 256;
constexpr int kMostInFlight = 100;

MqttSettings broker_of(const ExporterSettings& settings, const Teller& teller) {
  auto broker = settings.broker;
  broker.client_id = "calibrd-" + settings.cell;
  broker.will_topic = CellTopics(settings.prefix, settings.cell).status();
  broker.will_payload = status_payload(teller, false, std::nullopt);
  return broker;
}

/// PostgreSQL's words come on several.
std::string on_one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

}  // namespace

Exporter::Exporter(const ExporterSettings& settings, const api::CellService& service, Outbox& outbox,
                   ExporterLog log, ExporterWatch& watch)
    : settings_(settings),
      topics_(settings.prefix, settings.cell),
      outbox_(outbox),
      log_(std::move(log)),
      watch_(watch),
      window_(kWindow),
      guard_(random_instance()),
      teller_{settings.cell, settings.version, guard_.instance()},
      states_(service, topics_, teller_) {}

Result<std::unique_ptr<Exporter>> Exporter::start(const ExporterSettings& settings,
                                                  const api::CellService& service, Outbox& outbox,
                                                  ExporterLog log, ExporterWatch& watch) {
  std::unique_ptr<Exporter> exporter(new Exporter(settings, service, outbox, std::move(log), watch));
  auto client = MqttClient::start(broker_of(settings, exporter->teller_), exporter->events());
  if (!client) return client.error();
  exporter->client_ = *std::move(client);
  watch.exporters.set(1);
  exporter->thread_ = std::thread([self = exporter.get()] { self->run(); });
  return exporter;
}

Exporter::~Exporter() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
    }
    change_.notify_all();
    thread_.join();
  }
  if (client_) client_->stop();
}

void Exporter::wake() {
  const std::lock_guard lock(mutex_);
  is_woken_ = true;
  change_.notify_all();
}

/// They run on the library's thread and only leave word.
MqttEvents Exporter::events() {
  MqttEvents events;
  events.on_connect = [this] {
    const std::lock_guard lock(mutex_);
    is_connected_ = is_new_connection_ = is_woken_ = true;
    in_flight_ = 0;  // what was on its way is lost with the old connection
    watch_.connected.set(1);
    watch_.connects.add();
    trouble_.clear();
    change_.notify_all();
  };
  events.on_trouble = [this](const std::string& why) {
    {
      const std::lock_guard lock(mutex_);
      if (why.starts_with("no connection")) {
        is_connected_ = false;
        watch_.connected.set(0);
      }
      if (why == trouble_) return;  // said once, not at every attempt
      trouble_ = why;
    }
    log_("mqtt: " + why, false);
  };
  events.on_taken = [this] {
    const std::lock_guard lock(mutex_);
    in_flight_ = std::max(0, in_flight_ - 1);
  };
  events.on_message = [this](std::string topic, std::string payload) {
    const std::lock_guard lock(mutex_);
    // What is dropped is asked for again: the collector acknowledges what is sent to it once more.
    if (heard_.size() < kMostHeard) heard_.push_back({std::move(topic), std::move(payload)});
    is_woken_ = true;
    change_.notify_all();
  };
  return events;
}

void Exporter::run() {
  name_thread("mqtt exporter");
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    lock.unlock();
    look();
    lock.lock();
    change_.wait_for(lock, kPeriod, [this] { return is_ending_ || is_woken_; });
    is_woken_ = false;
  }
  lock.unlock();
  end();
}

void Exporter::look() {
  std::deque<Message> heard;
  bool is_connected = false, is_new = false;
  {
    const std::lock_guard lock(mutex_);
    heard.swap(heard_);
    is_connected = is_connected_;
    is_new = std::exchange(is_new_connection_, false);
  }
  if (is_new) greet();
  for (const auto& message : heard) hear(message);
  count_waiting();
  if (!is_connected) return;
  const auto publish_state = [this](const auto& topic, const auto& payload, auto expiry) {
    return publish(topic, payload, true, expiry);
  };
  const auto now = std::chrono::steady_clock::now();
  const auto voice = guard_.voice(now);
  watch_.contested.set(voice == Voice::contested ? 1 : 0);
  states_.look(publish_state, voice, now);
  refill();
  send_due();
}

/// A broker that has come back may have lost its state, or be another one.
void Exporter::greet() {
  client_->subscribe(topics_.acknowledgements());
  client_->subscribe(collector_topic(settings_.prefix));
  client_->subscribe(topics_.status());
  guard_.connected(std::chrono::steady_clock::now());
  states_.forget();
  window_.send_all_again();
  log_("mqtt: connected to " + settings_.broker.host + ":" + std::to_string(settings_.broker.port) +
           " as cell " + settings_.cell,
       true);
}

void Exporter::hear(const Message& message) {
  if (message.topic == topics_.status()) return hear_status(message.payload);
  // What an earlier collector refused may fit where this one stores it.
  if (message.topic == collector_topic(settings_.prefix)) return window_.begin_anew();
  if (message.topic != topics_.acknowledgements()) return;
  const auto acknowledgement = parse_acknowledgement(message.payload);
  if (acknowledgement) return note(*acknowledgement);
  log_("mqtt: an acknowledgement that is none came on " + message.topic + "; who else publishes there?",
       false);
}

void Exporter::hear_status(const std::string& status) {
  if (guard_.hear(status, std::chrono::steady_clock::now()))
    log_("mqtt: another daemon speaks as cell " + settings_.cell +
             "; give each its own mqtt.cell (and user). Until one is gone for a minute, no pose is told as "
             "valid",
         false);
}

void Exporter::note(const Acknowledgement& acknowledgement) {
  if (!acknowledgement.stored.empty()) {
    // Kept in the window where the disk refuses: it is sent again, and removed when that is acknowledged.
    if (auto removed = outbox_.remove(acknowledgement.stored); !removed) return;
    for (const auto& id : acknowledgement.stored)
      if (window_.drop(id)) watch_.acknowledged.add();
  }
  for (const auto& one : acknowledgement.refused)
    if (window_.drop(one.calibration_id)) {
      watch_.refused.add();
      log_("mqtt: the collector cannot store calibration " + one.calibration_id + " (" +
               on_one_line(one.reason) +
               "); it stays in the outbox and is tried again when a collector or the daemon starts",
           false);
    }
}

void Exporter::count_waiting() {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_count_) return;
  next_count_ = now + kCountPeriod;
  const auto waiting = outbox_.size();
  watch_.waiting.set(waiting ? *waiting : ExporterWatch::kNotCounted);
}

void Exporter::refill() {
  if (window_.room() == 0) return;
  // Before its rows: should it change in between, they are read again.
  window_.follow(outbox_.generation());
  const auto rows = outbox_.waiting(window_.newest(), static_cast<int>(window_.room()));
  if (!rows) {
    if (outbox_trouble_ != rows.error().message())
      log_("mqtt: the outbox cannot be read: " + (outbox_trouble_ = rows.error().message()), false);
    return;
  }
  outbox_trouble_.clear();
  for (const auto& row : *rows)
    window_.add(row.number, row.calibration.id, calibration_payload(settings_.cell, row.calibration));
}

void Exporter::send_due() {
  for (const auto& payload : window_.take_due(std::chrono::steady_clock::now()))
    if (publish(topics_.calibrations(), payload, false)) watch_.sent.add();
}

/// What is not taken now is told again: states when they are next looked at, calibrations until they are
/// acknowledged.
bool Exporter::publish(const std::string& topic, const std::string& payload, bool retain,
                       std::optional<std::chrono::seconds> expiry) {
  {
    const std::lock_guard lock(mutex_);
    if (!is_connected_ || in_flight_ >= kMostInFlight) return false;
    ++in_flight_;
  }
  if (client_->publish(topic, payload, retain, expiry)) return true;
  const std::lock_guard lock(mutex_);
  in_flight_ = std::max(0, in_flight_ - 1);  // it may have been set to 0 in between
  return false;
}

/// The last will is for ends that nobody had time for. However much is on its way: nothing comes after this.
void Exporter::end() {
  states_.end([this](const auto& topic, const auto& payload, auto expiry) {
    return client_->publish(topic, payload, true, expiry).has_value();
  });
}

}  // namespace calibrd::fleet
