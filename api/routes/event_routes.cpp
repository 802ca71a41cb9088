// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/responses.hpp"
#include "api/routes/robot_joints_stream.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

constexpr auto kHeartbeat = std::chrono::seconds(5);

/// Server-sent events as WHATWG HTML defines them (section 9.2): id, event and data of each, a comment now
/// and then so that both ends notice when the other is gone.
class EventStream : public BodyStream {
 public:
  EventStream(const EventHub& events, const std::string& last_id)
      : events_(events), listener_(events), last_(events.number_of(last_id)), is_resumed_(!last_id.empty()) {}

  std::string next() override {
    const auto batch = events_.after(last_);
    std::string text = is_first_ ? "retry: 1000\n\n" : "";
    // Of what was missed nothing but its outcome is known: whoever counts events must know that.
    if (batch.is_whole_state && is_resumed_) text += "event: reset\ndata: {}\n\n";
    for (const Event& event : batch.events)
      text +=
          "id: " + events_.id_of(event.number) + "\nevent: " + event.type + "\ndata: " + event.data + "\n\n";
    const auto now = std::chrono::steady_clock::now();
    if (text.empty() && now - written_at_ >= kHeartbeat) text = ":\n\n";
    if (!text.empty()) written_at_ = now;
    last_ = batch.last;
    is_first_ = false;
    is_resumed_ = true;
    return text;
  }

 private:
  const EventHub& events_;
  const EventHub::Listener listener_;
  std::optional<std::uint64_t> last_;
  bool is_resumed_, is_first_ = true;
  std::chrono::steady_clock::time_point written_at_;
};

/// Events and joints in one: a browser grants a host six connections, and every stream holds one of them.
class EventsAndJointsStream : public BodyStream {
 public:
  EventsAndJointsStream(const EventHub& events, const std::string& last_id, const CellService& service)
      : events_(events, last_id), joints_(service) {}

  std::string next() override { return events_.next() + joints_.next(); }
  std::chrono::milliseconds pause() const override { return joints_.pause(); }

 private:
  EventStream events_;
  RobotJointsStream joints_;
};

Response answer(const Request& request, const EventHub& events, const CellService& service) {
  if (auto unknown = unknown_query(request, {"joints"})) return problem(*unknown);
  const auto joints = request.query.find("joints");
  if (joints != request.query.end() && joints->second != "true" && joints->second != "false")
    return problem(ApiError::bad_query,
                   "joints: \"" + joints->second + "\" is neither \"true\" nor \"false\"");
  const auto last_id = request.header("last-event-id");
  Response response{200, {{"Content-Type", "text/event-stream"}, {"Cache-Control", "no-store"}}, {}};
  if (joints != request.query.end() && joints->second == "true")
    response.stream = std::make_shared<EventsAndJointsStream>(events, last_id, service);
  else
    response.stream = std::make_shared<EventStream>(events, last_id);
  return response;
}

}  // namespace

void add_event_routes(Router& router, const EventHub& events, const CellService& service) {
  router.add("GET", "/api/v1/events", Scope::read, Cost::quick,
             [&](const Request& request, const PathValues&) { return answer(request, events, service); });
}

}  // namespace calibrd::api
