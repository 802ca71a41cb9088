// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/collector/collector.hpp"

#include <algorithm>
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
constexpr std::size_t kInboxBytes = 64'000'000, kBatchBytes = 4'000'000;
constexpr milliseconds kPeriod{100};
constexpr int kFirstPause = 2, kLastPause = 20;  // periods between tries of the database
constexpr std::size_t kMostBytes = 1'000'000, kMostMisfits = 1000;

/// A name that stands in a document; nothing where it is none.
std::optional<std::string> name_in(const json::object& document, std::string_view key) {
  const auto* found = document.if_contains(key);
  if (!found || !found->is_string()) return std::nullopt;
  std::string name(found->as_string());
  return is_name(name) ? std::optional(std::move(name)) : std::nullopt;
}

}  // namespace

Collector::Collector(CollectorSettings settings, Log log)
    : settings_(std::move(settings)),
      log_(std::move(log)),
      inbox_(kInbox, kInboxBytes),
      warehouse_(settings_.database) {}

MqttEvents Collector::events() {
  MqttEvents events;
  events.on_connect = [this] {
    const std::lock_guard lock(mutex_);
    is_new_connection_ = true;
  };
  events.on_trouble = [this](const std::string& why) { say_once(why); };
  events.on_message = [this](const std::string& topic, std::string payload) {
    receive(topic, std::move(payload));
  };
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
  if (payload.size() > kMostBytes)
    return say_once("a message of " + std::to_string(payload.size()) + " bytes on " + topic +
                    " is dropped: no calibration is so long; who else publishes there?");
  const auto cell = cell_of(settings_.prefix, topic);
  boost::system::error_code failure;
  const auto value = json::parse(payload, failure);
  const auto* document = failure ? nullptr : value.if_object();
  const auto id = cell && document ? name_in(*document, "id") : std::nullopt;
  if (!id)
    return say_once("a message that is no calibration with an id came on " + topic +
                    " and is dropped; who else publishes there?");
  if (name_in(*document, "sensor")) return inbox_.put({*cell, *id, std::move(payload)});
  const std::lock_guard lock(mutex_);
  if (misfits_.size() < kMostMisfits)
    misfits_.push_back(
        {{*cell, *id, {}}, "its sensor has no name of letters, digits, '.', '_' and '-', at most 64"});
}

/// The retained greeting lets every daemon send again what was sent while no collector listened.
void Collector::greet(MqttClient& client) {
  client.subscribe(every_calibration(settings_.prefix));
  const auto now = utc_text(std::chrono::system_clock::now(), kUtcSeconds) + "Z";
  static_cast<void>(client.publish(collector_topic(settings_.prefix),
                                   R"({"format":"collector/1","since":")" + now + "\"}", true));
  log_("connected to the broker " + settings_.broker.host + ":" + std::to_string(settings_.broker.port),
       true);
}

Status Collector::run(const std::function<bool()>& is_ending) {
  warehouse_.end_when(is_ending);
  auto client = MqttClient::start(settings_.broker, events());
  if (!client) return client.error();
  look_at_database();
  while (!is_ending()) {
    bool is_new = false;
    {
      const std::lock_guard lock(mutex_);
      is_new = std::exchange(is_new_connection_, false);
    }
    if (is_new) greet(**client);
    refuse_misfits(**client);
    auto arrivals = inbox_.take(kBatch, kBatchBytes, kPeriod);
    if (!arrivals.empty()) keep(**client, std::move(arrivals), is_ending);
  }
  (*client)->stop();
  return Done{};
}

/// What is wrong with it is said before the first calibration comes, which may be days.
void Collector::look_at_database() {
  const auto status = warehouse_.prepare();
  is_prepared_ = status.has_value();
  if (status)
    log_("connected to the database", true);
  else
    say_once(status.error().message());
}

/// Until they are stored: a database that is gone comes back.
void Collector::keep(MqttClient& client, std::vector<Arrival> arrivals,
                     const std::function<bool()>& is_ending) {
  while (!is_ending()) {
    auto status = is_prepared_ ? Status(Done{}) : warehouse_.prepare();
    is_prepared_ = status.has_value();
    if (status) {
      status = warehouse_.store(arrivals);
      if (!status && status.error().code != WarehouseError::out_of_resources && warehouse_.is_connected())
        return keep_one_by_one(client, std::move(arrivals), is_ending);
    }
    if (status) {
      say_once({});
      pause_ = 0;
      return acknowledge(client, arrivals);
    }
    if (is_ending()) return;
    is_prepared_ = false;  // it may come back as another one
    say_once(status.error().message());
    pause(is_ending);
  }
}

/// One that cannot be stored must not stand in the way of the others. What may be stored later waits beside
/// what comes.
void Collector::keep_one_by_one(MqttClient& client, std::vector<Arrival> arrivals,
                                const std::function<bool()>& is_ending) {
  std::size_t left = 0;
  for (auto& arrival : arrivals) {
    if (is_ending()) return;
    const auto status =
        warehouse_.is_connected() ? warehouse_.store({arrival}) : Error{WarehouseError::no_connection, {}};
    if (status) {
      acknowledge(client, {arrival});
    } else if (status.error().code == WarehouseError::unfit) {
      refuse(client, arrival, status.error().detail);
    } else {
      is_prepared_ = false;  // its tables may be gone
      say_once(status.error().message());
      inbox_.put(std::move(arrival));
      ++left;
    }
  }
  if (left < arrivals.size()) pause_ = 0;
  if (left > 0) pause(is_ending);
}

void Collector::pause(const std::function<bool()>& is_ending) {
  pause_ = std::clamp(2 * pause_, kFirstPause, kLastPause);
  for (int i = 0; i < pause_ && !is_ending(); ++i) std::this_thread::sleep_for(kPeriod);
}

void Collector::refuse_misfits(MqttClient& client) {
  std::vector<Misfit> misfits;
  {
    const std::lock_guard lock(mutex_);
    misfits.swap(misfits_);
  }
  for (const auto& misfit : misfits) refuse(client, misfit.arrival, misfit.reason);
}

void Collector::acknowledge(MqttClient& client, const std::vector<Arrival>& stored) {
  std::map<std::string, Acknowledgement> by_cell;
  for (const auto& arrival : stored) by_cell[arrival.cell].stored.push_back(arrival.calibration_id);
  for (const auto& [cell, acknowledgement] : by_cell)
    static_cast<void>(client.publish(CellTopics(settings_.prefix, cell).acknowledgements(),
                                     acknowledgement_json(acknowledgement), false));
}

void Collector::refuse(MqttClient& client, const Arrival& arrival, const std::string& reason) {
  log_("cell " + arrival.cell + ", calibration " + arrival.calibration_id + " cannot be stored: " + reason,
       false);
  Acknowledgement acknowledgement;
  acknowledgement.refused.push_back({arrival.calibration_id, reason});
  static_cast<void>(client.publish(CellTopics(settings_.prefix, arrival.cell).acknowledgements(),
                                   acknowledgement_json(acknowledgement), false));
}

}  // namespace calibrd::fleet
