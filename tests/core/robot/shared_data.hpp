// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdlib>
#include <filesystem>

namespace calibrd::test {

/// The folder of test data beside the checkout; CALIBRD_SHARED_DATA wins over the compiled-in place.
inline std::filesystem::path shared_data() {
  if (const char* folder = std::getenv("CALIBRD_SHARED_DATA")) return folder;
  return CALIBRD_SHARED_DIR;
}

}  // namespace calibrd::test

/// Skips the test, saying so, when `path` (a std::filesystem::path) is absent.
#define SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "test data absent: " << (path).string()
