// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/durable_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <string>

namespace calibrd {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  Descriptor(const fs::path& file, int flags) : number_(::open(file.c_str(), flags | O_CLOEXEC, 0644)) {}
  Descriptor(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }

 private:
  const int number_;
};

bool write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const auto written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

Error file_error(int number, const fs::path& file, StorageError why) {
  auto code = why;
  if (number == ENOSPC || number == EDQUOT || number == EFBIG) code = StorageError::full;
  if (number == EROFS) code = StorageError::read_only;
  return {code, file.string() + " (" + std::generic_category().message(number) + ")"};
}

Status sync_folder(const fs::path& folder) {
  const auto& named = folder.empty() ? fs::path(".") : folder;
  const Descriptor descriptor(named, O_RDONLY | O_DIRECTORY);
  if (descriptor.number() < 0 || ::fsync(descriptor.number()) != 0) return file_error(errno, named);
  return Done{};
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  const std::unique_ptr<DIR, int (*)(DIR*)> stream(::opendir(folder.empty() ? "." : folder.c_str()),
                                                   [](DIR* open) { return open ? ::closedir(open) : 0; });
  while (const auto* entry = stream ? ::readdir(stream.get()) : nullptr) names.emplace_back(entry->d_name);
  std::sort(names.begin(), names.end());
  return names;
}

Status make_folders_durably(const fs::path& folder) {
  std::error_code failure;
  if (folder.empty() || fs::is_directory(folder, failure)) return Done{};
  if (auto above = make_folders_durably(folder.parent_path()); !above) return above;
  if (!fs::create_directory(folder, failure) && failure)
    return file_error(failure.value(), folder, StorageError::cannot_open);
  return sync_folder(folder.parent_path());
}

Status write_durably(const fs::path& file, std::string_view content) {
  auto fresh = file;
  fresh += ".new";
  {
    const Descriptor descriptor(fresh, O_WRONLY | O_CREAT | O_TRUNC);
    const bool is_written = descriptor.number() >= 0 && write_all(descriptor.number(), content) &&
                            ::fsync(descriptor.number()) == 0;
    if (!is_written) {
      auto error = file_error(errno, fresh);
      ::unlink(fresh.c_str());
      return error;
    }
  }
  if (::rename(fresh.c_str(), file.c_str()) != 0) return file_error(errno, file);
  return sync_folder(file.parent_path());
}

}  // namespace calibrd
