// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/storage/allocation_faults.hpp"

#include <sqlite3.h>

#include <cstdlib>
#include <new>

namespace {

thread_local bool counts = false, failed = false;
thread_local int left = 0;
sqlite3_mem_methods of_sqlite{};

bool fails_now() {
  if (!counts || left == 0 || --left != 0) return false;
  failed = true;
  return true;
}

void* allocate(int size) { return fails_now() ? nullptr : of_sqlite.xMalloc(size); }
void* reallocate(void* old, int size) { return fails_now() ? nullptr : of_sqlite.xRealloc(old, size); }

}  // namespace

void* operator new(std::size_t size) {
  void* memory = fails_now() ? nullptr : std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace calibrd {

AllocationsCount::AllocationsCount() { counts = true; }
AllocationsCount::~AllocationsCount() { counts = false; }

void AllocationsCount::fail(int n) {
  left = n;
  failed = false;
}

bool AllocationsCount::has_failed() { return failed; }

void AllocationsCount::hook_sqlite() {
  sqlite3_shutdown();
  sqlite3_config(SQLITE_CONFIG_GETMALLOC, &of_sqlite);
  static sqlite3_mem_methods hooked;
  hooked = of_sqlite;
  hooked.xMalloc = allocate;
  hooked.xRealloc = reallocate;
  sqlite3_config(SQLITE_CONFIG_MALLOC, &hooked);
}

}  // namespace calibrd
