// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/exporter/name_guard.hpp"

#include <boost/json/parse.hpp>
#include <cstdio>
#include <random>

namespace calibrd::fleet {
namespace {

// Longer than a client that was thrown out waits (BackOff): one that was there before us is back by then.
constexpr std::chrono::seconds kFirstSilence{6};
constexpr std::chrono::seconds kSilence{1};  // what the broker has kept comes right after the subscription
constexpr std::chrono::seconds kUndisputed{60};

std::string instance_in(std::string_view status) {
  boost::system::error_code failure;
  const auto value = boost::json::parse(status, failure);
  const auto* object = failure ? nullptr : value.if_object();
  const auto* instance = object ? object->if_contains("instance") : nullptr;
  return instance && instance->is_string() ? std::string(instance->as_string()) : std::string();
}

}  // namespace

void NameGuard::connected(Time now) {
  ++connections_;
  connected_at_ = now;
}

bool NameGuard::hear(std::string_view status, Time now) {
  const auto instance = instance_in(status);
  if (instance.empty() || instance == instance_) return false;
  // Left by an earlier run of this daemon, most likely.
  if (connections_ <= 1) return false;
  const bool is_news = voice(now) != Voice::contested;
  contested_at_ = now;
  return is_news;
}

Voice NameGuard::voice(Time now) const {
  const auto stood = now - connected_at_;
  if (contested_at_ && stood < kUndisputed) return Voice::contested;
  return stood < (connections_ <= 1 ? kFirstSilence : kSilence) ? Voice::waiting : Voice::clear;
}

std::string random_instance() {
  std::random_device random;
  std::string text;
  for (int i = 0; i < 4; ++i) {
    char word[9];
    std::snprintf(word, sizeof word, "%08x", random());
    text += word;
  }
  return text;
}

}  // namespace calibrd::fleet
