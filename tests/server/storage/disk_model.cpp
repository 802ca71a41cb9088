// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/storage/disk_model.hpp"

#include <algorithm>
#include <fstream>
#include <set>

namespace calibrd {
namespace {

constexpr std::int64_t kSector = 512;  // what a disk writes as a whole

bool is_kept(double kept, std::mt19937& random) {
  return std::uniform_real_distribution<double>(0, 1)(random) < kept;
}

}  // namespace

void DiskModel::create(const std::filesystem::path& file) {
  if (!names_.contains(file)) names_[file] = std::make_shared<File>();
}

void DiskModel::write(const std::filesystem::path& file, std::int64_t offset, std::string bytes) {
  names_.at(file)->open.push_back({offset, std::move(bytes)});
}

void DiskModel::truncate(const std::filesystem::path& file, std::int64_t size) {
  names_.at(file)->open.push_back({size, {}, true});
}

void DiskModel::sync(const std::filesystem::path& file) {
  File& synced = *names_.at(file);
  for (const Change& change : synced.open) apply(change, synced.synced);
  synced.open.clear();
}

void DiskModel::sync_names() { synced_names_ = names_; }

void DiskModel::remove(const std::filesystem::path& file) { names_.erase(file); }

void DiskModel::apply(const Change& change, std::string& content) {
  const auto offset = static_cast<std::size_t>(change.offset);
  if (change.is_truncation) {
    content.resize(offset);
    return;
  }
  content.resize(std::max(content.size(), offset + change.bytes.size()));
  content.replace(offset, change.bytes.size(), change.bytes);
}

std::string DiskModel::remains(const File& file, double kept, std::mt19937& random) {
  std::string content = file.synced;
  for (const Change& change : file.open) {
    if (change.is_truncation) {
      if (is_kept(kept, random)) apply(change, content);
      continue;
    }
    const auto end = change.offset + static_cast<std::int64_t>(change.bytes.size());
    for (auto at = change.offset; at < end;) {
      const auto next = std::min(end, (at / kSector + 1) * kSector);
      const auto from = static_cast<std::size_t>(at - change.offset);
      if (is_kept(kept, random))
        apply({at, change.bytes.substr(from, static_cast<std::size_t>(next - at))}, content);
      at = next;
    }
  }
  return content;
}

void DiskModel::write_remains(const std::filesystem::path& folder, double kept, std::mt19937& random) const {
  std::set<std::filesystem::path> all;
  for (const auto* names : {&names_, &synced_names_})
    for (const auto& [name, file] : *names) all.insert(name);
  for (const auto& name : all) {
    const Names& survivor = is_kept(kept, random) ? names_ : synced_names_;
    const auto found = survivor.find(name);
    if (found == survivor.end()) continue;
    std::ofstream(folder / name.filename(), std::ios::binary) << remains(*found->second, kept, random);
  }
}

}  // namespace calibrd
