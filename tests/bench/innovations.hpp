// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "core/drift/drift_watch.hpp"

namespace calibrd::bench {

/// What one frame told the test for a moved sensor.
struct RecordedInnovation {
  std::uint32_t cell = 0;
  double stamp_s = 0;
  DriftWatch::Innovation innovation;
};

/// Writes innovations into a file, which only a program of the same build reads.
class InnovationWriter {
 public:
  explicit InnovationWriter(const std::filesystem::path& path) : file_(path, std::ios::binary) {}
  bool is_open() const { return file_.is_open(); }
  void write(std::uint32_t cell, double stamp_s, const DriftWatch::Innovation& innovation);

 private:
  std::ofstream file_;
};

/// Empty when there is no such file, or nothing whole in it.
std::vector<RecordedInnovation> read_innovations(const std::filesystem::path& path);

}  // namespace calibrd::bench
