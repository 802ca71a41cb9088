// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/collector/collector.hpp"

#include <boost/json/parse.hpp>
#include <map>
#include <thread>
#include <utility>

#include "core/base/utc_text.hpp"
#include "fleet/messages/acknowledgement.hpp"
#include "fleet/messages/topics.hpp"

namespace calibrd::fleet {
namespace {

namespace json = boost::json;
using std::chrono::milliseconds;

constexpr std::size_t kInbox = 20'000, kBatch = 500;  // some kilobytes each
constexpr milliseconds kPeriod{100};
constexpr int kFirstPause = 2, kLastPause = 20;  // periods between tries of the database

/// The id of a calibration's document; nothing where it is none.
std::optional<std::string> id_of(const std::string& document) {
  boost::system::error_code failure;
  const auto value = json::parse(document, failure);
  const auto* object = failure ? nullptr : value.if_object();
  const auto* id = object ? object->if_contains("id") : nullptr;
  if (!id || !id->is_string() || !is_name(std::string_view(id->as_string().data(), id->as_string().size())))
    return std::nullopt;
  return std::string(id->as_string());
}

}  // namespace

Collector::Collector(CollectorSettings settings, Log log)
    : settings_(std::move(settings)), log_(std::move(log)), inbox_(kInbox), warehouse_(settings_.database) {}

MqttEvents Collector::events() {
  MqttEvents events;
  events.on_connect = [this] {
    const std::lock_guard lock(mutex_);
    is_new_connection_ = true;
  };
  events.on_trouble = [this](const std::string& why) { say_once(why); };
  events.on_message = [this](const std::string& topic, std::string payload) { receive(topic, std::move(payload)); };
  events.on_taken = [] {};
  return events;
}

void Collector::say_once(const std::string& trouble) {
  {
    const std::lock_guard lock(mutex_);
    if (trouble == trouble_) return;
    trouble_ = trouble;
  }
  if (!trouble.empty()) log_(trouble, false);
}

void Collector::receive(const std::string& topic, std::string payload) {
  const auto cell = cell_of(settings_.prefix, topic);
  const auto id = cell ? id_of(payload) : std::nullopt;
  if (!id) return say_once("a message that is no calibration came on " + topic + "; who else publishes there?");
  inbox_.put({*cell, *id, std::move(payload)});
}

/// The retained greeting lets every daemon send again what was sent while no collector listened.
void Collector::greet(MqttClient& client) {
  client.subscribe(every_calibration(settings_.prefix));
  const auto now = utc_text(std::chrono::system_clock::now(), kUtcSeconds) + "Z";
  static_cast<void>(
      client.publish(collector_topic(settings_.prefix), R"({"format":"collector/1","since":")" + now + "\"}", true));
  log_("connected to the broker " + settings_.broker.host + ":" + std::to_string(settings_.broker.port), true);
}

Status Collector::run(const std::function<bool()>& is_ending) {
  auto client = MqttClient::start(settings_.broker, events());
  if (!client) return client.error();
  while (!is_ending()) {
    bool is_new = false;
    {
      const std::lock_guard lock(mutex_);
      is_new = std::exchange(is_new_connection_, false);
    }
    if (is_new) greet(**client);
    auto arrivals = inbox_.take(kBatch, kPeriod);
    if (!arrivals.empty()) keep(**client, std::move(arrivals), is_ending);
  }
  (*client)->stop();
  return Done{};
}

/// Until they are stored: a database that is gone comes back.
void Collector::keep(MqttClient& client, std::vector<Arrival> arrivals, const std::function<bool()>& is_ending) {
  for (int pause = kFirstPause; !is_ending(); pause = std::min(2 * pause, kLastPause)) {
    auto status = is_prepared_ ? Status(Done{}) : warehouse_.prepare();
    is_prepared_ = status.has_value();
    if (status) status = warehouse_.store(arrivals);
    if (status) {
      say_once({});
      return acknowledge(client, arrivals);
    }
    if (status.error().code == WarehouseError::unfit) return keep_one_by_one(client, arrivals);
    is_prepared_ = false;  // it may come back as another one
    say_once(status.error().message());
    for (int i = 0; i < pause && !is_ending(); ++i) std::this_thread::sleep_for(kPeriod);
  }
}

/// One that cannot be stored must not stand in the way of the others.
void Collector::keep_one_by_one(MqttClient& client, const std::vector<Arrival>& arrivals) {
  for (const auto& arrival : arrivals) {
    const auto status = warehouse_.store({arrival});
    if (status)
      acknowledge(client, {arrival});
    else if (status.error().code == WarehouseError::unfit)
      refuse(client, arrival, status.error().detail);
  }
}

void Collector::acknowledge(MqttClient& client, const std::vector<Arrival>& stored) {
  std::map<std::string, Acknowledgement> by_cell;
  for (const auto& arrival : stored) by_cell[arrival.cell].stored.push_back(arrival.calibration_id);
  for (const auto& [cell, acknowledgement] : by_cell)
    static_cast<void>(client.publish(CellTopics(settings_.prefix, cell).acknowledgements(),
                                     acknowledgement_json(acknowledgement), false));
}

void Collector::refuse(MqttClient& client, const Arrival& arrival, const std::string& reason) {
  log_("cell " + arrival.cell + ", calibration " + arrival.calibration_id + " cannot be stored: " + reason, false);
  Acknowledgement acknowledgement;
  acknowledgement.refused.push_back({arrival.calibration_id, reason});
  static_cast<void>(client.publish(CellTopics(settings_.prefix, arrival.cell).acknowledgements(),
                                   acknowledgement_json(acknowledgement), false));
}

}  // namespace calibrd::fleet
