// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>

#include "api/clouds/frame_file.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"

namespace calibrd::api {
namespace {

using Time = std::chrono::steady_clock::time_point;

constexpr auto kAfterError = std::chrono::milliseconds(500);

struct FramesWanted {
  SensorFrameRequest frame;
  int rate_hz = 10;
  int count = 0;  ///< 0: without end
};

/// Frames as they come, never faster than asked for. Who reads slowly gets fewer: each is made when the one
/// before it has been taken.
class FrameStream : public BodyStream {
 public:
  FrameStream(const CellService& service, FramesWanted wanted)
      : service_(service), wanted_(std::move(wanted)) {}

  std::string next() override {
    const auto now = std::chrono::steady_clock::now();
    if (now < due_ || has_ended()) return {};
    const auto frame = service_.sensor_frame(wanted_.frame);
    if (!frame) {
      due_ = now + kAfterError;
      ++sent_;
      return frame_part(frame.error());
    }
    if (!*frame) return {};
    wanted_.frame.newer_than = (*frame)->stamp;
    due_ = std::max(due_ + std::chrono::microseconds(1'000'000 / wanted_.rate_hz), now);
    ++sent_;
    return frame_part(**frame);
  }
  std::chrono::milliseconds pause() const override { return std::chrono::milliseconds(5); }
  bool is_slow() const override { return std::chrono::steady_clock::now() >= due_; }
  bool has_ended() const override { return wanted_.count > 0 && sent_ >= wanted_.count; }

 private:
  const CellService& service_;
  FramesWanted wanted_;
  Time due_ = std::chrono::steady_clock::now();
  int sent_ = 0;
};

/// `value` keeps what it holds where the query does not name it.
std::optional<Error> read_whole(const Request& request, const std::string& name, int most, int& value) {
  const auto asked = request.query.find(name);
  if (asked == request.query.end()) return std::nullopt;
  const auto& text = asked->second;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure == std::errc() && end == text.data() + text.size() && value >= 1 && value <= most)
    return std::nullopt;
  return fail(ApiError::bad_query,
              name + ": a whole number from 1 to " + std::to_string(most) + " is wanted");
}

Response answer_frames(const Request& request, const PathValues& values, const CellService& service) {
  FramesWanted wanted{{values[0]}};
  if (auto unknown = unknown_query(request, {"step", "rate_hz", "count"})) return problem(*unknown);
  if (auto bad = read_whole(request, "step", 8, wanted.frame.step)) return problem(*bad);
  if (auto bad = read_whole(request, "rate_hz", 30, wanted.rate_hz)) return problem(*bad);
  if (auto bad = read_whole(request, "count", 1000, wanted.count)) return problem(*bad);
  if (const auto sensor = service.sensor(values[0]); !sensor) return problem(sensor.error());
  Response response{200, {{"Content-Type", "application/octet-stream"}, {"Cache-Control", "no-store"}}, {}};
  response.stream = std::make_shared<FrameStream>(service, std::move(wanted));
  return response;
}

}  // namespace

void add_frame_routes(Router& router, CellService& service) {
  router.add("GET", "/api/v1/sensors/{id}/frames", Scope::read, Cost::quick,
             [&service](const Request& request, const PathValues& values) {
               return answer_frames(request, values, service);
             });
}

}  // namespace calibrd::api
