// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/ray_tables.hpp"

#include <algorithm>

namespace calibrd {

std::shared_ptr<const RayTable> RayTables::of(const CameraModel& camera) {
  constexpr std::size_t kMost = 10;
  {
    const std::lock_guard lock(mutex_);
    const auto known = std::ranges::find_if(tables_, [&](const auto& table) { return table->fits(camera); });
    if (known != tables_.end()) {
      std::rotate(known, known + 1, tables_.end());
      return tables_.back();
    }
  }
  // Outside of the lock: a thread that waits inside a parallel loop may take up work that asks for a table.
  auto table = std::make_shared<const RayTable>(camera);
  const std::lock_guard lock(mutex_);
  if (tables_.size() == kMost) tables_.erase(tables_.begin());
  tables_.push_back(table);
  return table;
}

}  // namespace calibrd
