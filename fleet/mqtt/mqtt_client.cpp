// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/mqtt/mqtt_client.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <condition_variable>
#include <fstream>
#include <mutex>

namespace calibrd::fleet {
namespace {

constexpr int kQos = 1, kKeepAlive_s = 10, kFirstRetry_s = 1, kLastRetry_s = 5, kMaxInFlight = 100;
constexpr auto kFarewell = std::chrono::milliseconds(500);
constexpr int kFirstRefusal = 0x80;  // MQTT 5, 4.13: reason codes from here on are failures

/// libmosquitto counts its users.
void initialise() {
  static std::once_flag done;
  std::call_once(done, [] { mosquitto_lib_init(); });
}

const char* name_or_null(const std::filesystem::path& file) { return file.empty() ? nullptr : file.c_str(); }

Result<std::string> first_line(const std::filesystem::path& file) {
  std::string line;
  std::ifstream stream(file);
  if (!std::getline(stream, line)) return Error{MqttError::bad_password_file, file.string()};
  return line;
}

Status set_identity(mosquitto* client, const MqttSettings& settings) {
  if (settings.username.empty()) return Done{};
  std::string password;
  if (!settings.password_file.empty()) {
    auto read = first_line(settings.password_file);
    if (!read) return read.error();
    password = *std::move(read);
  }
  mosquitto_username_pw_set(client, settings.username.c_str(), password.empty() ? nullptr : password.c_str());
  return Done{};
}

Status set_tls(mosquitto* client, const MqttSettings& settings) {
  if (!settings.tls) return Done{};
  const char* folder = settings.ca.empty() ? "/etc/ssl/certs" : nullptr;
  const int code = mosquitto_tls_set(client, name_or_null(settings.ca), folder, name_or_null(settings.certificate),
                                     name_or_null(settings.key), nullptr);
  if (code != MOSQ_ERR_SUCCESS)
    return Error{MqttError::bad_tls_file, settings.ca.string() + " " + settings.certificate.string() + " (" +
                                              mosquitto_strerror(code) + ")"};
  return Done{};
}

}  // namespace

struct MqttClient::Handle {
  MqttEvents events;
  mosquitto* client = nullptr;
  std::mutex mutex;
  std::condition_variable left;
  bool has_left = false;  // guarded by mutex

  static Handle& of(void* self) { return *static_cast<Handle*>(self); }

  static void on_connect(mosquitto*, void* self, int reason, int, const mosquitto_property*) {
    if (reason == 0)
      of(self).events.on_connect();
    else
      of(self).events.on_trouble(std::string("the broker refuses the connection: ") + mosquitto_reason_string(reason));
  }
  static void on_disconnect(mosquitto*, void* self, int reason) {
    if (reason != 0)
      return of(self).events.on_trouble(std::string("no connection to the broker: ") + mosquitto_strerror(reason));
    const std::lock_guard lock(of(self).mutex);
    of(self).has_left = true;
    of(self).left.notify_all();
  }
  static void on_message(mosquitto*, void* self, const mosquitto_message* message) {
    of(self).events.on_message(message->topic, {static_cast<const char*>(message->payload),
                                                static_cast<std::size_t>(message->payloadlen)});
  }
  static void on_publish(mosquitto*, void* self, int, int reason, const mosquitto_property*) {
    if (reason >= kFirstRefusal)
      of(self).events.on_trouble(std::string("the broker refuses a message: ") + mosquitto_reason_string(reason));
    of(self).events.on_taken();
  }

  void set_up() {
    mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
    mosquitto_int_option(client, MOSQ_OPT_TCP_NODELAY, 1);
    mosquitto_max_inflight_messages_set(client, kMaxInFlight);
    mosquitto_reconnect_delay_set(client, kFirstRetry_s, kLastRetry_s, true);
    mosquitto_connect_v5_callback_set(client, on_connect);
    mosquitto_disconnect_callback_set(client, on_disconnect);
    mosquitto_message_callback_set(client, on_message);
    mosquitto_publish_v5_callback_set(client, on_publish);
  }

  ~Handle() {
    if (client) mosquitto_destroy(client);
  }
};

MqttClient::MqttClient(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
MqttClient::~MqttClient() { stop(); }

Result<std::unique_ptr<MqttClient>> MqttClient::start(const MqttSettings& settings, MqttEvents events) {
  initialise();
  auto handle = std::make_unique<Handle>();
  handle->events = std::move(events);
  handle->client = mosquitto_new(settings.client_id.c_str(), true, handle.get());
  if (!handle->client) return Error{MqttError::no_memory, {}};
  auto* client = handle->client;
  handle->set_up();
  if (auto status = set_identity(client, settings); !status) return status.error();
  if (auto status = set_tls(client, settings); !status) return status.error();
  if (!settings.will_topic.empty())
    mosquitto_will_set(client, settings.will_topic.c_str(), static_cast<int>(settings.will_payload.size()),
                       settings.will_payload.data(), kQos, true);
  // A broker that is not there yet is no error: the loop goes on trying.
  const int code = mosquitto_connect_async(client, settings.host.c_str(), settings.port, kKeepAlive_s);
  if (code == MOSQ_ERR_INVAL)
    return Error{MqttError::bad_address, settings.host + ":" + std::to_string(settings.port)};
  if (mosquitto_loop_start(client) != MOSQ_ERR_SUCCESS) return Error{MqttError::no_memory, {}};
  return std::unique_ptr<MqttClient>(new MqttClient(std::move(handle)));
}

Status MqttClient::publish(const std::string& topic, const std::string& payload, bool retain,
                           std::optional<std::chrono::seconds> expiry) {
  mosquitto_property* properties = nullptr;
  if (expiry)
    mosquitto_property_add_int32(&properties, MQTT_PROP_MESSAGE_EXPIRY_INTERVAL,
                                 static_cast<std::uint32_t>(expiry->count()));
  const int code = mosquitto_publish_v5(handle_->client, nullptr, topic.c_str(), static_cast<int>(payload.size()),
                                        payload.data(), kQos, retain, properties);
  mosquitto_property_free_all(&properties);
  if (code != MOSQ_ERR_SUCCESS) return Error{MqttError::not_sent, topic + " (" + mosquitto_strerror(code) + ")"};
  return Done{};
}

void MqttClient::subscribe(const std::string& topic) {
  mosquitto_subscribe(handle_->client, nullptr, topic.c_str(), kQos);
}

void MqttClient::stop() {
  if (!handle_) return;
  if (mosquitto_disconnect(handle_->client) == MOSQ_ERR_SUCCESS) {
    std::unique_lock lock(handle_->mutex);
    handle_->left.wait_for(lock, kFarewell, [&] { return handle_->has_left; });
  }
  // Forced: a name server that does not answer holds the library's thread for half a minute.
  mosquitto_loop_stop(handle_->client, true);
  handle_.reset();
}

}  // namespace calibrd::fleet
