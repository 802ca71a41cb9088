// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/rtde_session.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace calibrd::sim {
namespace {

constexpr std::uint8_t kRecipe = 1;

void append(Bytes& bytes, std::uint64_t value, std::size_t count) {
  for (std::size_t i = count; i-- > 0;) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void append(Bytes& bytes, double value) { append(bytes, std::bit_cast<std::uint64_t>(value), 8); }

Bytes package(char type, const Bytes& payload) {
  Bytes bytes;
  append(bytes, payload.size() + 3, 2);
  bytes.push_back(static_cast<std::uint8_t>(type));
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

Bytes yes_or_no(char type, bool yes) { return package(type, {static_cast<std::uint8_t>(yes ? 1 : 0)}); }

/// 7: running, 3: no power on the arm.
std::uint32_t robot_mode(const RtdeState& state) { return state.arm_has_power ? 7 : 3; }

/// As safety_mode and safety_status count: 1 normal, 7 the robot's own emergency stop.
std::uint32_t safety(const RtdeState& state) { return state.emergency_stop ? 7 : 1; }

/// Bit 0 normal; bits 6, 7 and 10: emergency stop of the robot, any emergency stop, stopped for safety.
std::uint32_t safety_bits(const RtdeState& state) { return state.emergency_stop ? 0x4c0 : 0x1; }

struct Variable {
  const char* type;
  void (*write)(const RtdeState&, Bytes&);
};

const std::map<std::string, Variable, std::less<>>& variables() {
  static const std::map<std::string, Variable, std::less<>> all{
      {"timestamp", {"DOUBLE", [](const RtdeState& s, Bytes& b) { append(b, s.timestamp_s); }}},
      {"actual_q",
       {"VECTOR6D",
        [](const RtdeState& s, Bytes& b) {
          for (double q : s.positions_rad) append(b, q);
        }}},
      {"actual_qd",
       {"VECTOR6D",
        [](const RtdeState& s, Bytes& b) {
          for (double v : s.velocities_rad_s) append(b, v);
        }}},
      {"robot_mode", {"INT32", [](const RtdeState& s, Bytes& b) { append(b, robot_mode(s), 4); }}},
      {"safety_mode", {"INT32", [](const RtdeState& s, Bytes& b) { append(b, safety(s), 4); }}},
      {"safety_status", {"INT32", [](const RtdeState& s, Bytes& b) { append(b, safety(s), 4); }}},
      {"safety_status_bits", {"UINT32", [](const RtdeState& s, Bytes& b) { append(b, safety_bits(s), 4); }}},
  };
  return all;
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> names{""};
  for (const char c : list) {
    if (c == ',')
      names.emplace_back();
    else
      names.back() += c;
  }
  return names;
}

}  // namespace

std::optional<Bytes> RtdeSession::take(std::span<const std::uint8_t> bytes,
                                       const ControllerSettings& settings) {
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  Bytes replies;
  while (pending_.size() >= 3) {
    const std::size_t size = static_cast<std::size_t>(pending_[0] << 8 | pending_[1]);
    if (size < 3) return std::nullopt;
    if (pending_.size() < size) break;
    const auto reply = answer(pending_[2], std::span(pending_).first(size).subspan(3), settings);
    if (!reply) return std::nullopt;
    if (settings.rtde_texts != 0) {
      const Bytes said = text("a word before the answer");
      replies.insert(replies.end(), said.begin(), said.end());
    }
    replies.insert(replies.end(), reply->begin(), reply->end());
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(size));
  }
  return replies;
}

std::optional<Bytes> RtdeSession::answer(std::uint8_t type, std::span<const std::uint8_t> payload,
                                         const ControllerSettings& settings) {
  switch (type) {
    case 'V': {
      if (payload.size() != 2) return std::nullopt;
      const int wanted = payload[0] << 8 | payload[1];
      const bool accepted = wanted >= 1 && wanted <= settings.rtde_protocol;
      if (accepted) protocol_ = wanted;
      return yes_or_no('V', accepted);
    }
    case 'v': {
      Bytes version;
      for (const unsigned part : {settings.rtde_protocol > 1 ? 5U : 3U, 2U, 0U, 1U}) append(version, part, 4);
      return package('v', version);
    }
    case 'O':
      return set_up_outputs(payload, settings);
    case 'S':
      streaming_ = !recipe_.empty();
      return yes_or_no('S', streaming_);
    case 'P':
      streaming_ = false;
      return yes_or_no('P', true);
    default:
      return std::nullopt;  // inputs among them: nobody who only reads sets up any
  }
}

Bytes RtdeSession::set_up_outputs(std::span<const std::uint8_t> payload, const ControllerSettings& settings) {
  frequency_hz_ = protocol_ > 1 ? 500 : 125;
  if (protocol_ > 1 && payload.size() > 8) {
    std::uint64_t bits = 0;
    for (const std::uint8_t byte : payload.first(8)) bits = bits << 8 | byte;
    const double wanted = std::bit_cast<double>(bits);
    if (wanted >= 1 && wanted <= 500) frequency_hz_ = wanted;
    payload = payload.subspan(8);
  }
  recipe_ = split({payload.begin(), payload.end()});
  std::string types;
  bool complete = true;
  for (const std::string& name : recipe_) {
    const auto known = variables().find(name);
    const bool found = known != variables().end() && name != settings.rtde_missing;
    types.append(types.empty() ? "" : ",").append(found ? known->second.type : "NOT_FOUND");
    complete = complete && found;
  }
  if (!complete) recipe_.clear();
  Bytes reply;
  if (protocol_ > 1) reply.push_back(complete ? kRecipe : 0);
  reply.insert(reply.end(), types.begin(), types.end());
  return package('O', reply);
}

Bytes RtdeSession::data(const RtdeState& state, const ControllerSettings& settings) {
  if (!streaming_) return {};
  Bytes payload;
  if (protocol_ > 1) payload.push_back(kRecipe);
  for (const std::string& name : recipe_) variables().at(name).write(state, payload);
  Bytes bytes = package('U', payload);
  if (settings.rtde_texts != 0 && sent_++ % 10 == 0) {
    const Bytes said = text("a word between the data");
    bytes.insert(bytes.begin(), said.begin(), said.end());
  }
  return bytes;
}

Bytes RtdeSession::text(const std::string& what) const {
  constexpr std::uint8_t kInformation = 3;
  const std::string source = "simulator";
  Bytes payload;
  payload.push_back(protocol_ > 1 ? static_cast<std::uint8_t>(what.size()) : kInformation);
  payload.insert(payload.end(), what.begin(), what.end());
  if (protocol_ > 1) {
    payload.push_back(static_cast<std::uint8_t>(source.size()));
    payload.insert(payload.end(), source.begin(), source.end());
    payload.push_back(kInformation);
  }
  return package('M', payload);
}

}  // namespace calibrd::sim
