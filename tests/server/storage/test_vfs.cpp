// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/storage/test_vfs.hpp"

#include <cstring>
#include <new>

namespace calibrd {
namespace {

/// What SQLite holds of an open file; the real one of the system's VFS lies behind it.
struct File {
  sqlite3_file base;
  TestVfs* vfs;
  std::string* path;  // null: a temporary file, which no crash needs
  bool syncs_folder;  // a new journal: the system's VFS syncs the folder with it
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

sqlite3_vfs* system_vfs() {
  static sqlite3_vfs* const vfs = sqlite3_vfs_find("unix");
  return vfs;
}

File& of(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }
TestVfs& of(sqlite3_vfs* vfs) { return *static_cast<TestVfs*>(vfs->pAppData); }

int close(sqlite3_file* file) {
  File& own = of(file);
  delete own.path;
  return own.real()->pMethods ? own.real()->pMethods->xClose(own.real()) : SQLITE_OK;
}

int read(sqlite3_file* file, void* to, int size, sqlite3_int64 offset) {
  File& own = of(file);
  if (const int code = own.vfs->enter(VfsCall::read)) return code;
  return own.real()->pMethods->xRead(own.real(), to, size, offset);
}

int write(sqlite3_file* file, const void* from, int size, sqlite3_int64 offset) {
  File& own = of(file);
  if (const int code = own.vfs->enter(VfsCall::write)) return code;
  if (const int code = own.path ? own.vfs->change() : SQLITE_OK) return code;
  if (own.path)
    own.vfs->mutable_disk().write(
        *own.path, offset, std::string(static_cast<const char*>(from), static_cast<std::size_t>(size)));
  return own.real()->pMethods->xWrite(own.real(), from, size, offset);
}

int truncate(sqlite3_file* file, sqlite3_int64 size) {
  File& own = of(file);
  if (const int code = own.vfs->enter(VfsCall::truncate)) return code;
  if (const int code = own.path ? own.vfs->change() : SQLITE_OK) return code;
  if (own.path) own.vfs->mutable_disk().truncate(*own.path, size);
  return own.real()->pMethods->xTruncate(own.real(), size);
}

int sync(sqlite3_file* file, int flags) {
  File& own = of(file);
  if (const int code = own.vfs->enter(VfsCall::sync)) return code;
  if (const int code = own.path ? own.vfs->change() : SQLITE_OK) return code;
  if (own.path) {
    own.vfs->mutable_disk().sync(*own.path);
    if (own.syncs_folder) own.vfs->mutable_disk().sync_names();
    own.syncs_folder = false;
  }
  return own.real()->pMethods->xSync(own.real(), flags);
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
  File& own = of(file);
  if (const int code = own.vfs->enter(VfsCall::size)) return code;
  return own.real()->pMethods->xFileSize(own.real(), size);
}

int lock(sqlite3_file* file, int level) {
  File& own = of(file);
  if (const int code = own.vfs->enter(VfsCall::lock)) return code;
  return own.real()->pMethods->xLock(own.real(), level);
}

int unlock(sqlite3_file* file, int level) {
  return of(file).real()->pMethods->xUnlock(of(file).real(), level);
}
int check_lock(sqlite3_file* file, int* is_reserved) {
  return of(file).real()->pMethods->xCheckReservedLock(of(file).real(), is_reserved);
}
int control(sqlite3_file* file, int what, void* argument) {
  return of(file).real()->pMethods->xFileControl(of(file).real(), what, argument);
}
int sector_size(sqlite3_file* file) { return of(file).real()->pMethods->xSectorSize(of(file).real()); }
int characteristics(sqlite3_file* file) {
  return of(file).real()->pMethods->xDeviceCharacteristics(of(file).real());
}

int shm_map(sqlite3_file* file, int page, int size, int extend, void volatile** memory) {
  File& own = of(file);
  if (const int code = own.vfs->enter(VfsCall::shm_map)) return code;
  return own.real()->pMethods->xShmMap(own.real(), page, size, extend, memory);
}

int shm_lock(sqlite3_file* file, int offset, int n, int flags) {
  File& own = of(file);
  const bool is_unlock = (flags & SQLITE_SHM_UNLOCK) != 0;
  if (const int code = is_unlock ? SQLITE_OK : own.vfs->enter(VfsCall::shm_lock)) return code;
  return own.real()->pMethods->xShmLock(own.real(), offset, n, flags);
}
void shm_barrier(sqlite3_file* file) { of(file).real()->pMethods->xShmBarrier(of(file).real()); }
int shm_unmap(sqlite3_file* file, int remove) {
  return of(file).real()->pMethods->xShmUnmap(of(file).real(), remove);
}

constexpr sqlite3_io_methods kMethods{
    2,         close,      read,    write,       truncate,        sync,    file_size, lock,
    unlock,    check_lock, control, sector_size, characteristics, shm_map, shm_lock,  shm_barrier,
    shm_unmap, nullptr,    nullptr};

int open(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  File& own = *new (file) File{{nullptr}, &of(vfs), nullptr, false};
  own.real()->pMethods = nullptr;
  if (const int code = own.vfs->enter(VfsCall::open)) return code;
  const bool is_new = name && !std::filesystem::exists(name);
  if (const int code = is_new && (flags & SQLITE_OPEN_CREATE) ? own.vfs->change() : SQLITE_OK) return code;
  const int code = system_vfs()->xOpen(system_vfs(), name, own.real(), flags, out_flags);
  if (own.real()->pMethods) own.base.pMethods = &kMethods;
  if (code != SQLITE_OK || !name) return code;
  own.path = new std::string(name);
  own.vfs->mutable_disk().create(name);
  constexpr int kJournals = SQLITE_OPEN_WAL | SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_SUPER_JOURNAL;
  own.syncs_folder = is_new && (flags & kJournals) != 0;
  return code;
}

int remove(sqlite3_vfs* vfs, const char* name, int sync_folder) {
  TestVfs& own = of(vfs);
  if (const int code = own.enter(VfsCall::remove)) return code;
  if (const int code = own.change()) return code;
  own.mutable_disk().remove(name);
  if (sync_folder) own.mutable_disk().sync_names();
  return system_vfs()->xDelete(system_vfs(), name, sync_folder);
}

}  // namespace

const char* name_of(VfsCall call) {
  constexpr std::array kNames{"xOpen",   "xRead",     "xWrite", "xTruncate", "xSync",
                              "xDelete", "xFileSize", "xLock",  "xShmMap",   "xShmLock"};
  return kNames.at(static_cast<std::size_t>(call));
}

TestVfs::TestVfs() : vfs_(*system_vfs()) {
  vfs_.szOsFile += static_cast<int>(sizeof(File));
  vfs_.pNext = nullptr;
  vfs_.zName = kName;
  vfs_.pAppData = this;
  vfs_.xOpen = open;
  vfs_.xDelete = remove;
  sqlite3_vfs_register(&vfs_, 0);
}

TestVfs::~TestVfs() { sqlite3_vfs_unregister(&vfs_); }

void TestVfs::fail(VfsCall call, int n, int code, bool for_good) { fault_ = Fault{call, n, code, for_good}; }

void TestVfs::heal() {
  fault_.reset();
  is_off_ = false;
  cut_at_.reset();
}

int TestVfs::enter(VfsCall call) {
  if (is_off_) return SQLITE_IOERR;
  ++counts_.at(static_cast<std::size_t>(call));
  if (!fault_ || fault_->call != call) return SQLITE_OK;
  const bool fails = fault_->for_good ? --fault_->left <= 0 : --fault_->left == 0;
  has_failed_ = has_failed_ || fails;
  return fails ? fault_->code : SQLITE_OK;
}

int TestVfs::change() {
  if (cut_at_ && changes_ + 1 >= *cut_at_) is_off_ = true;
  if (is_off_) return SQLITE_IOERR;
  ++changes_;
  return SQLITE_OK;
}

}  // namespace calibrd
