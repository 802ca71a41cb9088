// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/shared_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <utility>

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {
namespace {

constexpr int kSizeSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

}  // namespace

Result<FileDescriptor> create_shared_memory(std::size_t words) {
  FileDescriptor fd(::memfd_create("calibrd-frames", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (!fd) return system_error("memory for frames");
  if (::ftruncate(fd.get(), static_cast<off_t>(words * sizeof(SharedWord))) != 0)
    return system_error("memory for frames");
  if (::fcntl(fd.get(), F_ADD_SEALS, kSizeSeals) != 0) return system_error("sealing the memory for frames");
  return fd;
}

Result<SharedWords> SharedWords::map(int fd, std::size_t words, MapAccess access) {
  struct stat status {};
  const std::size_t bytes = words * sizeof(SharedWord);
  const int seals = ::fcntl(fd, F_GET_SEALS);
  if (::fstat(fd, &status) != 0 || seals < 0) return system_error("memory for frames");
  if (static_cast<std::size_t>(status.st_size) != bytes || (seals & kSizeSeals) != kSizeSeals)
    return sensor_error(SensorError::version_mismatch, "size of the frame ring");
  const int protection = access == MapAccess::read ? PROT_READ : PROT_READ | PROT_WRITE;
  void* address = ::mmap(nullptr, bytes, protection, MAP_SHARED, fd, 0);
  if (address == MAP_FAILED) return system_error("mapping the frame ring");
  return SharedWords(static_cast<SharedWord*>(address), words);
}

SharedWords::SharedWords(SharedWords&& other) noexcept
    : words_(std::exchange(other.words_, nullptr)), count_(std::exchange(other.count_, 0)) {}

SharedWords::~SharedWords() {
  if (words_ != nullptr) ::munmap(words_, count_ * sizeof(SharedWord));
}

}  // namespace calibrd
