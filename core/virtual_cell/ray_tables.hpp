// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <mutex>
#include <vector>

#include "core/virtual_cell/ray_table.hpp"

namespace calibrd {

/// The ray tables of the cameras used last, shared by the virtual cells of one robot: undoing distortion
/// costs more than casting the rays. Safe to call from any thread.
class RayTables {
 public:
  std::shared_ptr<const RayTable> of(const CameraModel& camera);

 private:
  std::mutex mutex_;
  std::vector<std::shared_ptr<const RayTable>> tables_;  // guarded by mutex_; the last used last
};

}  // namespace calibrd
