// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/storage_error.hpp"

#include <string>

namespace calibrd {
namespace {

const char* text(StorageError code) {
  switch (code) {
    case StorageError::cannot_open:
      return "the calibration store cannot be opened; set storage.path to a place this user may write to";
    case StorageError::in_use:
      return "another calibrd is running on this calibration store; end that one, or set another "
             "storage.path for this one";
    case StorageError::not_a_store:
      return "not a calibration store; move the file away, or set another storage.path";
    case StorageError::newer_schema:
      return "the store was written by a newer calibrd; run that version, or set another storage.path";
    case StorageError::cannot_read:
      return "the calibration store cannot be read; check the disk";
    case StorageError::cannot_write:
      return "the calibration store cannot be written; check free space and permissions of storage.path";
    case StorageError::full:
      return "the disk of the calibration store is full; make room on it, calibrd goes on by itself";
    case StorageError::read_only:
      return "the disk of the calibration store is read-only; make it writable again (a disk that has failed "
             "is often made read-only: look at the system's log)";
    case StorageError::damaged:
      return "the calibration store is damaged; check the disk, restore a backup or go on with what was "
             "saved";
    case StorageError::out_of_memory:
      return "the calibration store ran out of memory; give the daemon more";
    case StorageError::contradiction:
      return "the calibration store refuses what contradicts the rest of it; please report this with the log";
  }
  return "unknown storage error";
}

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "storage"; }
  std::string message(int code) const override { return text(static_cast<StorageError>(code)); }
};

}  // namespace

const std::error_category& storage_category() {
  static const Category category;
  return category;
}

std::error_code make_error_code(StorageError code) { return {static_cast<int>(code), storage_category()}; }

}  // namespace calibrd
