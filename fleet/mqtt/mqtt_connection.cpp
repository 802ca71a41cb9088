// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/mqtt/mqtt_connection.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace calibrd::fleet {
namespace {

constexpr int kQos = 1, kKeepAlive_s = 10, kMaxInFlight = 100;
constexpr int kPeriod_ms = 1000, kPeriodWhileConnecting_ms = 50;
constexpr std::chrono::seconds kSubscribeAgain{10};
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
  const int code = mosquitto_tls_set(client, name_or_null(settings.ca), folder,
                                     name_or_null(settings.certificate), name_or_null(settings.key), nullptr);
  if (code != MOSQ_ERR_SUCCESS)
    return Error{MqttError::bad_tls_file, settings.ca.string() + " " + settings.certificate.string() + " (" +
                                              mosquitto_strerror(code) + ")"};
  return Done{};
}

}  // namespace

struct MqttConnection::Callbacks {
  static MqttConnection& of(void* self) { return *static_cast<MqttConnection*>(self); }

  static void on_connect(mosquitto*, void* self, int reason, int, const mosquitto_property*) {
    if (reason != 0) {
      of(self).refusal_ =
          std::string("the broker refuses the connection: ") + mosquitto_reason_string(reason);
      return;
    }
    of(self).is_up_ = true;
    of(self).events_.on_connect();
  }
  static void on_disconnect(mosquitto*, void* self, int reason) { of(self).farewell_ = reason; }
  static void on_message(mosquitto*, void* self, const mosquitto_message* message) {
    of(self).events_.on_message(message->topic, {static_cast<const char*>(message->payload),
                                                 static_cast<std::size_t>(message->payloadlen)});
  }
  static void on_subscribe(mosquitto*, void* self, int number, int count, const int* granted,
                           const mosquitto_property*) {
    for (int i = 0; i < count; ++i) of(self).note_subscription(number, granted[i]);
  }
  static void on_publish(mosquitto*, void* self, int, int reason, const mosquitto_property*) {
    if (reason >= kFirstRefusal)
      of(self).events_.on_trouble(std::string("the broker refuses a message: ") +
                                  mosquitto_reason_string(reason));
    --of(self).in_flight_;
    of(self).events_.on_taken();
  }
};

MqttConnection::MqttConnection(MqttEvents events) : events_(std::move(events)) {}

MqttConnection::~MqttConnection() {
  if (client_) mosquitto_destroy(client_);
  if (wake_fd_ >= 0) close(wake_fd_);
}

Result<std::unique_ptr<MqttConnection>> MqttConnection::make(const MqttSettings& settings,
                                                             MqttEvents events) {
  initialise();
  std::unique_ptr<MqttConnection> connection(new MqttConnection(std::move(events)));
  if (auto status = connection->set_up(settings); !status) return status.error();
  return connection;
}

Status MqttConnection::set_up(const MqttSettings& settings) {
  host_ = settings.host;
  port_ = settings.port;
  wake_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  client_ = mosquitto_new(settings.client_id.empty() ? nullptr : settings.client_id.c_str(), true, this);
  if (wake_fd_ < 0 || !client_) return Error{MqttError::no_memory, {}};
  mosquitto_threaded_set(client_, true);  // publish() only puts it into the queue: run() writes
  mosquitto_int_option(client_, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
  mosquitto_int_option(client_, MOSQ_OPT_TCP_NODELAY, 1);
  mosquitto_max_inflight_messages_set(client_, kMaxInFlight);
  mosquitto_connect_v5_callback_set(client_, Callbacks::on_connect);
  mosquitto_disconnect_callback_set(client_, Callbacks::on_disconnect);
  mosquitto_message_callback_set(client_, Callbacks::on_message);
  mosquitto_subscribe_v5_callback_set(client_, Callbacks::on_subscribe);
  mosquitto_publish_v5_callback_set(client_, Callbacks::on_publish);
  if (auto status = set_identity(client_, settings); !status) return status;
  if (auto status = set_tls(client_, settings); !status) return status;
  if (!settings.will_topic.empty())
    mosquitto_will_set(client_, settings.will_topic.c_str(), static_cast<int>(settings.will_payload.size()),
                       settings.will_payload.data(), kQos, true);
  return Done{};
}

std::string MqttConnection::run() {
  // Not the library's way of not waiting: that tries only the first of the host's addresses.
  const int code = mosquitto_connect(client_, host_.c_str(), port_, kKeepAlive_s);
  if (code != MOSQ_ERR_SUCCESS) return why(code);
  auto ended = serve();
  is_up_ = false;
  return ended;
}

std::string MqttConnection::serve() {
  int code = MOSQ_ERR_SUCCESS;
  while (code == MOSQ_ERR_SUCCESS && !is_abandoned_) {
    subscribe_again();
    code = step();
  }
  if (!refusal_.empty()) return refusal_;
  return why(code == MOSQ_ERR_NO_CONN && farewell_ != 0 ? farewell_ : code);
}

/// In place of mosquitto_loop(), whose select() cannot wait for descriptors from 1024 on.
int MqttConnection::step() {
  const auto write = [this] {
    return mosquitto_want_write(client_) ? mosquitto_loop_write(client_, 1) : int{MOSQ_ERR_SUCCESS};
  };
  // While TLS shakes hands the socket can be written to, but there is nothing to write: waiting for that
  // would spin.
  const bool is_up = is_up_;
  if (!is_up)
    if (const int code = write(); code != MOSQ_ERR_SUCCESS) return code;
  const int socket = mosquitto_socket(client_);
  if (socket < 0) return MOSQ_ERR_NO_CONN;
  const bool has_output = is_up && mosquitto_want_write(client_);
  pollfd waited[] = {{socket, static_cast<short>(has_output ? POLLIN | POLLOUT : POLLIN), 0},
                     {wake_fd_, POLLIN, 0}};
  if (poll(waited, 2, is_up ? kPeriod_ms : kPeriodWhileConnecting_ms) < 0 && errno != EINTR)
    return MOSQ_ERR_ERRNO;
  if (waited[1].revents != 0) {
    eventfd_t count = 0;
    static_cast<void>(eventfd_read(wake_fd_, &count));
  }
  if ((waited[0].revents & ~POLLOUT) != 0)
    if (const int code = mosquitto_loop_read(client_, 1); code != MOSQ_ERR_SUCCESS) return code;
  if (is_up && mosquitto_socket(client_) >= 0)
    if (const int code = write(); code != MOSQ_ERR_SUCCESS) return code;
  return mosquitto_loop_misc(client_);  // pings, and ends what is silent
}

std::string MqttConnection::why(int code) const {
  std::string text = code == MOSQ_ERR_ERRNO  ? std::strerror(errno)
                     : code >= kFirstRefusal ? mosquitto_reason_string(code)
                                             : mosquitto_strerror(code);
  return "no connection to the broker: " + text;
}

Status MqttConnection::publish(const std::string& topic, const std::string& payload, bool retain,
                               std::optional<std::chrono::seconds> expiry) {
  if (!is_up_) return Error{MqttError::not_sent, topic + " (" + mosquitto_strerror(MOSQ_ERR_NO_CONN) + ")"};
  mosquitto_property* properties = nullptr;
  if (expiry)
    mosquitto_property_add_int32(&properties, MQTT_PROP_MESSAGE_EXPIRY_INTERVAL,
                                 static_cast<std::uint32_t>(expiry->count()));
  ++in_flight_;
  const int code = mosquitto_publish_v5(client_, nullptr, topic.c_str(), static_cast<int>(payload.size()),
                                        payload.data(), kQos, retain, properties);
  mosquitto_property_free_all(&properties);
  wake();
  if (code == MOSQ_ERR_SUCCESS) return Done{};
  --in_flight_;
  return Error{MqttError::not_sent, topic + " (" + mosquitto_strerror(code) + ")"};
}

void MqttConnection::subscribe(const std::string& topic) {
  {
    const std::lock_guard lock(mutex_);  // the answer must not come before the number is known
    int number = 0;
    if (mosquitto_subscribe(client_, &number, topic.c_str(), kQos) == MOSQ_ERR_SUCCESS)
      subscribing_[number] = topic;
  }
  wake();
}

void MqttConnection::note_subscription(int number, int reason) {
  std::string topic;
  {
    const std::lock_guard lock(mutex_);
    const auto found = subscribing_.find(number);
    if (found == subscribing_.end()) return;
    topic = std::move(found->second);
    subscribing_.erase(found);
  }
  if (reason < kFirstRefusal) return;
  refused_.push_back(topic);
  refused_at_ = std::chrono::steady_clock::now();
  events_.on_trouble("the broker refuses the subscription to " + topic + " (" +
                     mosquitto_reason_string(reason) +
                     "): nothing is heard there until it does not; check the broker's access control list");
}

/// A list that was mended is no reason for a broker to end the connection.
void MqttConnection::subscribe_again() {
  if (refused_.empty() || std::chrono::steady_clock::now() - refused_at_ < kSubscribeAgain) return;
  std::vector<std::string> topics;
  topics.swap(refused_);
  for (const auto& topic : topics) subscribe(topic);
}

void MqttConnection::leave(bool with_will) {
  mosquitto_disconnect_v5(
      client_, with_will ? MQTT_RC_DISCONNECT_WITH_WILL_MSG : MQTT_RC_NORMAL_DISCONNECTION, nullptr);
  wake();
}

void MqttConnection::abandon() {
  is_abandoned_ = true;
  wake();
}

void MqttConnection::wake() const { static_cast<void>(eventfd_write(wake_fd_, 1)); }

}  // namespace calibrd::fleet
