// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "api/routes/message.hpp"

namespace calibrd::api {

/// Large answers that took their time to make, as long as somebody is still being sent them: many who ask for
/// the same at once get one, not each their own. Safe to call from any thread.
class SharedAnswers {
 public:
  /// What `make` answers, or has answered to the same path and query. None is older than the question: it was
  /// begun after the request had come. Only status 200 is shared.
  Response get(const Request& request, const std::function<Response()>& make);

 private:
  struct Entry {
    std::mutex making;  // held while the answer is made
    // Guarded by mutex_:
    std::chrono::steady_clock::time_point begun;
    Response answer;  // without its body
    std::weak_ptr<const std::string> body;
  };

  std::shared_ptr<Entry> entry_of(const Request& request);
  std::optional<Response> answer_of(const Entry& entry, const Request& request);

  std::mutex mutex_;  // guards what follows; never held while an answer is made
  std::map<std::string, std::shared_ptr<Entry>> entries_;
};

}  // namespace calibrd::api
