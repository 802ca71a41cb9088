// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd::sim {

struct BenchOptions {
  std::filesystem::path description;
  std::filesystem::path urdf;
  std::vector<std::filesystem::path> models;
  int frames = 300;
};

/// Renders frames of the moving robot at 30 Hz of its time, on one thread, and prints the CPU time of each kind.
Status run_bench(const BenchOptions& options);

}  // namespace calibrd::sim
