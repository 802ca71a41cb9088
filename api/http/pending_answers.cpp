// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/pending_answers.hpp"

#include <utility>

namespace calibrd::api {

PendingAnswers::Answer::Answer(PendingAnswers& all, const void* body, std::size_t bytes,
                               std::function<void()> give_up)
    : all_(all), place_(all.add({body, std::move(give_up)}, bytes)) {}

void PendingAnswers::Answer::note_progress() {
  if (place_->body) all_.waiting_.splice(all_.waiting_.end(), all_.waiting_, place_);
}

/// The newest stays whatever its size: an answer larger than the limit can be had, alone.
PendingAnswers::Place PendingAnswers::add(Waiting waiting, std::size_t bytes) {
  auto& body = bodies_[waiting.body];
  if (body.answers++ == 0) {
    body.bytes = bytes;
    held_ += bytes;
  }
  const auto place = waiting_.insert(waiting_.end(), std::move(waiting));
  while (held_ > most_bytes_ && waiting_.begin() != place) {
    const auto longest = waiting_.begin();
    given_up_.splice(given_up_.end(), waiting_, longest);
    release(*longest);
    longest->give_up();
  }
  bytes_.set(static_cast<std::int64_t>(held_));
  return place;
}

void PendingAnswers::release(Waiting& waiting) {
  const auto body = bodies_.find(std::exchange(waiting.body, nullptr));
  if (--body->second.answers > 0) return;
  held_ -= body->second.bytes;
  bodies_.erase(body);
}

void PendingAnswers::forget(Place place) {
  if (!place->body) {
    given_up_.erase(place);
    return;
  }
  release(*place);
  waiting_.erase(place);
  bytes_.set(static_cast<std::int64_t>(held_));
}

}  // namespace calibrd::api
