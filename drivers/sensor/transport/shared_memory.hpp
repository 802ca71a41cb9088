// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/sensor/transport/file_descriptor.hpp"

namespace calibrd {

/// Memory two processes share, seen as 64-bit words. Every access is atomic, so neither side can observe half
/// a word and neither depends on how the other's compiler lays out a struct.
using SharedWord = std::atomic<std::uint64_t>;
static_assert(SharedWord::is_always_lock_free && sizeof(SharedWord) == 8);

/// Anonymous memory of `words` zeroed words whose size nobody can change any more: a mapping of it cannot
/// fault, whatever the other process does. Close-on-exec.
Result<FileDescriptor> create_shared_memory(std::size_t words);

enum class MapAccess { read, read_write };

/// A mapping of such memory; unmaps itself. Moving keeps the addresses.
class SharedWords {
 public:
  /// Refused unless the memory holds exactly `words` words and its size is sealed.
  static Result<SharedWords> map(int fd, std::size_t words, MapAccess access);

  SharedWords(SharedWords&& other) noexcept;
  SharedWords& operator=(SharedWords&& other) = delete;
  ~SharedWords();

  /// Writing through a mapping made for reading ends the process: only the ring's writer takes the mutable
  /// view.
  std::span<SharedWord> words() { return {words_, count_}; }
  std::span<const SharedWord> words() const { return {words_, count_}; }

 private:
  SharedWords(SharedWord* words, std::size_t count) : words_(words), count_(count) {}
  SharedWord* words_;
  std::size_t count_;
};

}  // namespace calibrd
