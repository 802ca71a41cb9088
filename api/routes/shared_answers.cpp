// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/shared_answers.hpp"

#include <utility>

namespace calibrd::api {

Response SharedAnswers::get(const Request& request, const std::function<Response()>& make) {
  const auto entry = entry_of(request);
  const std::lock_guard one_at_a_time(entry->making);
  if (auto answer = answer_of(*entry, request)) return *std::move(answer);
  const auto begun = std::chrono::steady_clock::now();
  auto answer = make();
  if (answer.status != 200) return answer;
  answer.shared_body = std::make_shared<const std::string>(std::exchange(answer.body, {}));
  const std::lock_guard lock(mutex_);
  entry->begun = begun;
  entry->answer = answer;
  entry->body = std::exchange(entry->answer.shared_body, nullptr);
  return answer;
}

std::optional<Response> SharedAnswers::answer_of(const Entry& entry, const Request& request) {
  const std::lock_guard lock(mutex_);
  auto body = entry.body.lock();
  if (!body || entry.begun < request.came) return std::nullopt;
  auto answer = entry.answer;
  answer.shared_body = std::move(body);
  return answer;
}

/// Forgets, by the way, what nobody holds any more.
std::shared_ptr<SharedAnswers::Entry> SharedAnswers::entry_of(const Request& request) {
  std::string name = request.path;
  for (const auto& [key, value] : request.query) name.append("\n").append(key).append("\n").append(value);
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [](const auto& named) {
    return named.second.use_count() == 1 && named.second->body.expired();
  });
  auto& entry = entries_[name];
  if (!entry) entry = std::make_shared<Entry>();
  return entry;
}

}  // namespace calibrd::api
