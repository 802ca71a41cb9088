// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The functions of the C library under their own names: the program's come before the library's, for every
// object in it.
#include "tests/drivers/faults/call_faults.hpp"

#include <dlfcn.h>
#include <netdb.h>
#include <poll.h>
#include <pthread.h>
#include <spawn.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <new>

namespace calibrd::faults {
namespace {

std::atomic<int> chosen{-1}, left{0}, error_number{0};
std::atomic<bool> failed{false};
thread_local int bystanders = 0;

/// Sets errno and counts down.
bool fails_now(Call call) {
  if (bystanders > 0 || chosen != static_cast<int>(call) || left <= 0 || --left != 0) return false;
  failed = true;
  errno = error_number;
  return true;
}

/// The library's own function of this name.
template <class Function>
Function* real(Function*, const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

const char* name_of(Call call) {
  constexpr std::array kNames{"socket",      "connect",     "getsockopt",  "setsockopt", "ioctl",
                              "getsockname", "getpeername", "epoll_ctl",   "epoll_wait", "recvmsg",
                              "send",        "poll",        "getaddrinfo", "pthread",    "eventfd",
                              "memfd",       "ftruncate",   "fstat",       "fcntl",      "mmap",
                              "socketpair",  "spawn",       "recv",        "waitpid",    "allocation"};
  return kNames.at(static_cast<std::size_t>(call));
}

void fail(Call call, int n, int error) {
  failed = false;
  error_number = error;
  left = n;
  chosen = static_cast<int>(call);
}

bool heal() {
  chosen = -1;
  return failed;
}

Bystander::Bystander() { ++bystanders; }
Bystander::~Bystander() { --bystanders; }

}  // namespace calibrd::faults

using calibrd::faults::Call;
using calibrd::faults::fails_now;
using calibrd::faults::real;

// One that tells of a failure by -1 and errno.
#define CALIBRD_FAULTY(name, parameters, ...)              \
  int name parameters {                                    \
    static const auto next = real(&::name, #name);         \
    return fails_now(Call::name) ? -1 : next(__VA_ARGS__); \
  }

extern "C" {

CALIBRD_FAULTY(socket, (int family, int type, int protocol) noexcept, family, type, protocol)
CALIBRD_FAULTY(connect, (int fd, const sockaddr* address, socklen_t size), fd, address, size)
CALIBRD_FAULTY(getsockopt, (int fd, int level, int name, void* value, socklen_t* size) noexcept, fd, level,
               name, value, size)
CALIBRD_FAULTY(setsockopt, (int fd, int level, int name, const void* value, socklen_t size) noexcept, fd,
               level, name, value, size)
CALIBRD_FAULTY(getsockname, (int fd, sockaddr* address, socklen_t* size) noexcept, fd, address, size)
CALIBRD_FAULTY(getpeername, (int fd, sockaddr* address, socklen_t* size) noexcept, fd, address, size)
CALIBRD_FAULTY(epoll_ctl, (int epoll, int what, int fd, epoll_event* event) noexcept, epoll, what, fd, event)
CALIBRD_FAULTY(epoll_wait, (int epoll, epoll_event* events, int most, int timeout), epoll, events, most,
               timeout)
CALIBRD_FAULTY(poll, (pollfd * fds, nfds_t count, int timeout), fds, count, timeout)
CALIBRD_FAULTY(eventfd, (unsigned count, int flags) noexcept, count, flags)
CALIBRD_FAULTY(memfd_create, (const char* name, unsigned flags) noexcept, name, flags)
CALIBRD_FAULTY(ftruncate, (int fd, off_t size) noexcept, fd, size)
CALIBRD_FAULTY(fstat, (int fd, struct stat* status) noexcept, fd, status)
CALIBRD_FAULTY(socketpair, (int family, int type, int protocol, int* pair) noexcept, family, type, protocol,
               pair)
CALIBRD_FAULTY(waitpid, (pid_t id, int* status, int options), id, status, options)

ssize_t recvmsg(int fd, msghdr* message, int flags) {
  static const auto next = real(&::recvmsg, "recvmsg");
  return fails_now(Call::recvmsg) ? -1 : next(fd, message, flags);
}

ssize_t send(int fd, const void* bytes, size_t size, int flags) {
  static const auto next = real(&::send, "send");
  return fails_now(Call::send) ? -1 : next(fd, bytes, size, flags);
}

ssize_t recv(int fd, void* buffer, size_t size, int flags) {
  static const auto next = real(&::recv, "recv");
  return fails_now(Call::recv) ? -1 : next(fd, buffer, size, flags);
}

void* mmap(void* address, size_t size, int protection, int flags, int fd, off_t offset) noexcept {
  static const auto next = real(&::mmap, "mmap");
  return fails_now(Call::mmap) ? MAP_FAILED : next(address, size, protection, flags, fd, offset);
}

int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list rest;
  va_start(rest, request);
  void* argument = va_arg(rest, void*);
  va_end(rest);
  static const auto next = real(&::ioctl, "ioctl");
  return fails_now(Call::ioctl) ? -1 : next(fd, request, argument);
}

int fcntl(int fd, int command, ...) {
  va_list rest;
  va_start(rest, command);
  void* argument = va_arg(rest, void*);
  va_end(rest);
  static const auto next = real(&::fcntl, "fcntl");
  return fails_now(Call::fcntl) ? -1 : next(fd, command, argument);
}

// These return what went wrong.
int getaddrinfo(const char* host, const char* service, const addrinfo* hints, addrinfo** found) {
  static const auto next = real(&::getaddrinfo, "getaddrinfo");
  return fails_now(Call::getaddrinfo) ? errno : next(host, service, hints, found);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                   void* argument) noexcept {
  static const auto next = real(&::pthread_create, "pthread_create");
  return fails_now(Call::pthread_create) ? errno : next(thread, attributes, start, argument);
}

int posix_spawn(pid_t* id, const char* path, const posix_spawn_file_actions_t* files,
                const posix_spawnattr_t* attributes, char* const* arguments, char* const* variables) {
  static const auto next = real(&::posix_spawn, "posix_spawn");
  return fails_now(Call::posix_spawn) ? errno : next(id, path, files, attributes, arguments, variables);
}

}  // extern "C"

void* operator new(std::size_t size) {
  void* memory = fails_now(Call::allocation) ? nullptr : std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
