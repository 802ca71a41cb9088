// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/world_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <thread>
#include <utility>

#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {
namespace {

constexpr std::uint64_t kMagic = 0x31'6d'69'73'62'6c'61'63ULL;  // "calbsim1"
constexpr std::size_t kStateWords = (sizeof(WorldState) + 7) / 8;
using Words = std::array<std::uint64_t, kStateWords>;

}  // namespace

/// What lies at the start of the file; the cell's bytes follow. Readers and writer are of one build, which
/// `magic` and `state_size` make sure of. The state is kept in atomic words: a sequence lock over plain
/// memory would be a data race.
struct SharedWorld {
  std::uint64_t magic;
  std::uint64_t state_size;
  std::uint64_t cell_size;
  std::atomic<std::int64_t> beat_ns;
  std::atomic<std::uint64_t> sequence;  // odd while a change is being written
  std::array<std::atomic<std::uint64_t>, kStateWords> words;
};

static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

namespace {

const std::byte* cell_bytes(const SharedWorld* shared) {
  return reinterpret_cast<const std::byte*>(shared) + sizeof(SharedWorld);
}

/// A file descriptor that closes itself.
struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

bool is_owned(const std::filesystem::path& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  return file.number >= 0 && ::flock(file.number, LOCK_EX | LOCK_NB) != 0;
}

}  // namespace

Result<WorldFile> WorldFile::create(const std::filesystem::path& path, const Cell& cell,
                                    const WorldState& state) {
  if (is_owned(path)) return sim_error(SimError::world_in_use, path.string());
  const std::vector<std::byte> bytes = to_bytes(cell);
  const std::filesystem::path draft = path.string() + "." + std::to_string(::getpid());
  std::error_code ignored;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  std::filesystem::remove(draft, ignored);
  WorldFile world;
  world.path_ = draft;
  world.size_ = sizeof(SharedWorld) + bytes.size();
  world.file_ = ::open(draft.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (world.file_ < 0 || ::flock(world.file_, LOCK_EX | LOCK_NB) != 0 ||
      ::posix_fallocate(world.file_, 0, static_cast<off_t>(world.size_)) != 0)
    return sim_error(SimError::world_unwritable, path.string());
  void* memory = ::mmap(nullptr, world.size_, PROT_READ | PROT_WRITE, MAP_SHARED, world.file_, 0);
  if (memory == MAP_FAILED) return sim_error(SimError::world_unwritable, path.string());
  world.shared_ = new (memory) SharedWorld{};
  world.shared_->magic = kMagic;
  world.shared_->state_size = sizeof(WorldState);
  world.shared_->cell_size = bytes.size();
  std::memcpy(static_cast<std::byte*>(memory) + sizeof(SharedWorld), bytes.data(), bytes.size());
  world.publish(state);
  world.beat(monotonic_ns());
  std::error_code failed;
  std::filesystem::rename(draft, path, failed);  // readers see the whole file or none
  if (failed) return sim_error(SimError::world_unwritable, path.string());
  world.path_ = path;
  return world;
}

WorldFile::WorldFile(WorldFile&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      shared_(std::exchange(other.shared_, nullptr)),
      size_(other.size_) {}

WorldFile::~WorldFile() {
  if (file_ < 0) return;
  if (shared_ != nullptr) {
    beat(monotonic_ns() - 2 * kBeatLost_ns);  // tells readers at once
    ::munmap(shared_, size_);
  }
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  ::close(file_);
}

void WorldFile::publish(const WorldState& state) {
  Words words{};
  std::memcpy(words.data(), &state, sizeof(state));
  const std::uint64_t sequence = shared_->sequence.load(std::memory_order_relaxed);
  shared_->sequence.store(sequence + 1, std::memory_order_relaxed);
  for (std::size_t i = 0; i < kStateWords; ++i) shared_->words[i].store(words[i], std::memory_order_release);
  shared_->sequence.store(sequence + 2, std::memory_order_release);
}

void WorldFile::beat(std::int64_t now_ns) { shared_->beat_ns.store(now_ns, std::memory_order_relaxed); }

Result<WorldView> WorldView::open(const std::filesystem::path& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat info {};
  if (file.number < 0 || ::fstat(file.number, &info) != 0)
    return sim_error(SimError::world_unreadable, path.string());
  WorldView view;
  view.size_ = static_cast<std::size_t>(info.st_size);
  if (view.size_ < sizeof(SharedWorld)) return sim_error(SimError::world_mismatch, path.string());
  void* memory = ::mmap(nullptr, view.size_, PROT_READ, MAP_SHARED, file.number, 0);
  if (memory == MAP_FAILED) return sim_error(SimError::world_unreadable, path.string());
  view.shared_ = static_cast<const SharedWorld*>(memory);
  const SharedWorld& shared = *view.shared_;
  if (shared.magic != kMagic || shared.state_size != sizeof(WorldState) ||
      shared.cell_size != view.size_ - sizeof(SharedWorld))
    return sim_error(SimError::world_mismatch, path.string());
  auto cell = cell_from_bytes({cell_bytes(view.shared_), shared.cell_size});
  if (!cell) return cell.error();
  view.cell_ = std::make_unique<Cell>(std::move(*cell));
  return view;
}

WorldView::WorldView(WorldView&& other) noexcept
    : cell_(std::move(other.cell_)), shared_(std::exchange(other.shared_, nullptr)), size_(other.size_) {}

WorldView::~WorldView() {
  if (shared_ != nullptr) ::munmap(const_cast<SharedWorld*>(shared_), size_);
}

std::optional<WorldState> WorldView::read() const {
  constexpr int kTries = 1000;
  Words words;
  for (int i = 0; i < kTries; ++i) {
    const std::uint64_t before = shared_->sequence.load(std::memory_order_acquire);
    for (std::size_t w = 0; w < kStateWords; ++w)
      words[w] = shared_->words[w].load(std::memory_order_acquire);
    if ((before & 1) == 0 && shared_->sequence.load(std::memory_order_relaxed) == before) {
      WorldState state;
      std::memcpy(static_cast<void*>(&state), words.data(), sizeof(state));
      return state;
    }
    std::this_thread::yield();
  }
  return std::nullopt;
}

bool WorldView::alive(std::int64_t now_ns) const {
  return now_ns - shared_->beat_ns.load(std::memory_order_relaxed) < kBeatLost_ns;
}

}  // namespace calibrd::sim
