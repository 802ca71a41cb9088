// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <list>
#include <map>

#include "api/metrics/metric.hpp"

namespace calibrd::api {

/// What clients have asked for and not taken yet. Where it gets too much, those who have taken nothing for
/// longest lose their connections: whoever reads gets an answer, however many others do not. One thread.
class PendingAnswers {
 public:
  /// `bytes` shows how much it is at the moment.
  PendingAnswers(std::size_t most_bytes, Gauge& bytes) : most_bytes_(most_bytes), bytes_(bytes) {}

 private:
  struct Waiting {
    const void* body;
    std::function<void()> give_up;
  };
  using Place = std::list<Waiting>::iterator;

 public:
  /// An answer that waits for its client, as long as it lives.
  class Answer {
   public:
    /// `body`: where its bytes are; several answers may share them, then they count once. `give_up` ends the
    /// connection, and must not end this object before it returns.
    Answer(PendingAnswers& all, const void* body, std::size_t bytes, std::function<void()> give_up);
    ~Answer() { all_.forget(place_); }
    Answer(const Answer&) = delete;
    Answer& operator=(const Answer&) = delete;

    /// Its client has taken some of it.
    void note_progress();

   private:
    PendingAnswers& all_;
    const Place place_;
  };

 private:
  struct Body {
    std::size_t bytes = 0;
    int answers = 0;
  };

  Place add(Waiting waiting, std::size_t bytes);
  void release(Waiting& waiting);
  void forget(Place place);

  const std::size_t most_bytes_;
  Gauge& bytes_;
  std::size_t held_ = 0;
  std::map<const void*, Body> bodies_;
  std::list<Waiting> waiting_;   // those who have taken something last stand last
  std::list<Waiting> given_up_;  // not gone yet, but counted no more
};

}  // namespace calibrd::api
