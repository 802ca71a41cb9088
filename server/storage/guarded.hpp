// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <exception>
#include <new>

#include "server/storage/calibration_store.hpp"

namespace calibrd {

/// Every call from outside: one at a time, and memory that is not there, or a disk that does not answer, is
/// an error like any other.
template <class Call>
auto CalibrationStore::guarded(const Call& call) -> decltype(call()) {
  const std::lock_guard lock(mutex_);
  try {
    auto answer = call();
    if (!answer && answer.error().code == StorageError::damaged) note(answer.error());
    return answer;
  } catch (const std::bad_alloc&) {
    return Error{StorageError::out_of_memory, {}};
  } catch (const std::exception& failure) {  // of std::filesystem, on a disk that dies
    return Error{StorageError::cannot_read, failure.what()};
  }
}

}  // namespace calibrd
