// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <mutex>

#include "drivers/sim/world/world_file.hpp"

namespace calibrd::sim {

/// Finds the simulator, whenever it comes and goes. Safe to call from any thread.
class WorldWatch {
 public:
  explicit WorldWatch(std::filesystem::path path) : path_(std::move(path)) {}

  /// The world of the simulator that runs now; null when none does. Another pointer is another simulator.
  std::shared_ptr<const WorldView> current() {
    const std::lock_guard lock(mutex_);
    if (view_ && view_->alive(monotonic_ns())) return view_;
    auto opened = WorldView::open(path_);
    if (!opened || !opened->alive(monotonic_ns())) return nullptr;
    view_ = std::make_shared<const WorldView>(std::move(*opened));
    return view_;
  }

 private:
  std::filesystem::path path_;
  std::mutex mutex_;
  std::shared_ptr<const WorldView> view_;
};

}  // namespace calibrd::sim
