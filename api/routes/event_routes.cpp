// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/responses.hpp"
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

Response answer(const Request& request, const EventHub& events) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  Response response{200, {{"Content-Type", "text/event-stream"}, {"Cache-Control", "no-store"}}, {}};
  response.stream = std::make_shared<EventStream>(events, request.header("last-event-id"));
  return response;
}

}  // namespace

void add_event_routes(Router& router, const EventHub& events) {
  router.add("GET", "/api/v1/events", Scope::read, Cost::quick,
             [&events](const Request& request, const PathValues&) { return answer(request, events); });
}

}  // namespace calibrd::api
