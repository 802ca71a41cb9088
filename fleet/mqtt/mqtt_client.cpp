// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// Connects again and again. libmosquitto would do so by itself, but gives up for good where a broker refuses,
// says good-bye or fails in TLS: all of that passes.
#include "fleet/mqtt/mqtt_client.hpp"

#include <condition_variable>
#include <mutex>
#include <random>
#include <thread>

#include "core/base/thread_name.hpp"
#include "fleet/mqtt/back_off.hpp"
#include "fleet/mqtt/mqtt_connection.hpp"

namespace calibrd::fleet {
namespace {

using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kFarewell{500}, kLook{5};
constexpr int kMostPort = 65535;

Status check_address(const MqttSettings& settings) {
  if (settings.host.empty() || settings.port <= 0 || settings.port > kMostPort)
    return Error{MqttError::bad_address, settings.host + ":" + std::to_string(settings.port)};
  return Done{};
}

}  // namespace

/// Shared with the thread, which a name server that does not answer may hold for longer than stop() waits.
struct MqttClient::Handle {
  MqttSettings settings;
  MqttEvents events;

  std::mutex mutex;  // guards what follows
  std::condition_variable change;
  std::shared_ptr<MqttConnection> current;  // nothing between two of them
  bool is_ending = false, has_ended = false;

  std::mutex event_mutex;  // held while an event is told
  bool is_silent = false;  // guarded by event_mutex

  template <class Tell>
  void tell(const Tell& tell_it) {
    const std::lock_guard lock(event_mutex);
    if (!is_silent) tell_it();
  }

  MqttEvents guarded_events() {
    MqttEvents guarded;
    guarded.on_connect = [this] { tell([&] { events.on_connect(); }); };
    guarded.on_trouble = [this](const std::string& why) { tell([&] { events.on_trouble(why); }); };
    guarded.on_message = [this](std::string topic, std::string payload) {
      tell([&] { events.on_message(std::move(topic), std::move(payload)); });
    };
    guarded.on_taken = [this] { tell([&] { events.on_taken(); }); };
    return guarded;
  }

  void run() {
    name_thread("mqtt");
    BackOff back_off;
    std::minstd_rand random(std::random_device{}());
    for (;;) {
      const auto begin = Steady::now();
      const bool stood = connect_once();
      const auto lasted =
          stood ? std::chrono::duration_cast<milliseconds>(Steady::now() - begin) : milliseconds(0);
      const double share = std::uniform_real_distribution<double>()(random);
      std::unique_lock lock(mutex);
      if (change.wait_for(lock, back_off.next(lasted, share), [this] { return is_ending; })) break;
    }
    const std::lock_guard lock(mutex);
    has_ended = true;
    change.notify_all();
  }

  /// Whether there was a connection.
  bool connect_once() {
    bool stood = false;
    auto told = guarded_events();
    told.on_connect = [&stood, inner = std::move(told.on_connect)] {
      stood = true;
      inner();
    };
    auto made = MqttConnection::make(settings, std::move(told));
    const std::shared_ptr<MqttConnection> connection = made ? *std::move(made) : nullptr;
    if (!connection) {
      tell([&] { events.on_trouble("no connection to the broker: " + made.error().message()); });
      return false;
    }
    {
      const std::lock_guard lock(mutex);
      if (is_ending) return false;
      current = connection;
    }
    const auto why = connection->run();
    if (forget_current()) tell([&] { events.on_trouble(why); });
    return stood;
  }

  /// True: there is to be another one.
  bool forget_current() {
    const std::lock_guard lock(mutex);
    current.reset();
    return !is_ending;
  }

  std::shared_ptr<MqttConnection> connection() {
    const std::lock_guard lock(mutex);
    return current;
  }

  /// The last will is for messages, too, that the broker did not take in time: one of them may be the
  /// farewell.
  void leave(MqttConnection& connection) {
    const auto end = Steady::now() + kFarewell;
    while (connection.is_up() && connection.in_flight() > 0 && Steady::now() < end)
      std::this_thread::sleep_for(kLook);
    connection.leave(connection.in_flight() > 0);
  }

  bool wait_for_end(milliseconds patience) {
    std::unique_lock lock(mutex);
    return change.wait_for(lock, patience, [this] { return has_ended; });
  }
};

MqttClient::MqttClient(std::shared_ptr<Handle> handle) : handle_(std::move(handle)) {}
MqttClient::~MqttClient() { stop(); }

Status MqttClient::check(const MqttSettings& settings) {
  if (auto status = check_address(settings); !status) return status;
  if (const auto tried = MqttConnection::make(settings, {}); !tried) return tried.error();
  return Done{};
}

Result<std::unique_ptr<MqttClient>> MqttClient::start(const MqttSettings& settings, MqttEvents events) {
  if (auto status = check_address(settings); !status) return status.error();
  auto handle = std::make_shared<Handle>();
  handle->settings = settings;
  handle->events = std::move(events);
  std::unique_ptr<MqttClient> client(new MqttClient(handle));
  client->thread_ = std::thread([handle] { handle->run(); });
  return client;
}

Status MqttClient::publish(const std::string& topic, const std::string& payload, bool retain,
                           std::optional<std::chrono::seconds> expiry) {
  if (const auto connection = handle_->connection())
    return connection->publish(topic, payload, retain, expiry);
  return Error{MqttError::not_sent, topic};
}

void MqttClient::subscribe(const std::string& topic) {
  if (const auto connection = handle_->connection()) connection->subscribe(topic);
}

void MqttClient::stop() {
  if (!handle_) return;
  {
    const std::lock_guard lock(handle_->mutex);
    handle_->is_ending = true;
    handle_->change.notify_all();
  }
  if (const auto connection = handle_->connection()) {
    if (connection->is_up()) {
      handle_->leave(*connection);
      handle_->wait_for_end(kFarewell);
    }
    connection->abandon();
  }
  const bool has_ended = handle_->wait_for_end(kFarewell);
  {
    const std::lock_guard lock(handle_->event_mutex);
    handle_->is_silent = true;
  }
  // A name server that does not answer holds the thread for half a minute. It owns all that it still uses.
  has_ended ? thread_.join() : thread_.detach();
  handle_.reset();
}

}  // namespace calibrd::fleet
