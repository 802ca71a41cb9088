// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace calibrd::faults {

/// What the code of the links asks of the system; operator new besides.
enum class Call {
  socket,
  connect,
  getsockopt,
  setsockopt,
  ioctl,
  getsockname,
  getpeername,
  epoll_ctl,
  epoll_wait,
  recvmsg,
  send,
  poll,
  getaddrinfo,
  pthread_create,
  eventfd,
  memfd_create,
  ftruncate,
  fstat,
  fcntl,
  mmap,
  socketpair,
  posix_spawn,
  recv,
  waitpid,
  allocation
};
const char* name_of(Call call);

/// The n-th such call from now on, counted from 1, of all threads that are not a Bystander fails with `error`
/// (an errno, or an EAI_ of getaddrinfo; an allocation throws).
void fail(Call call, int n, int error);
/// No call fails from now on. True: one has failed since fail().
bool heal();

/// The calls of this thread always work and are not counted while one of these lives: the test's own.
class Bystander {
 public:
  Bystander();
  ~Bystander();
  Bystander(const Bystander&) = delete;
};

}  // namespace calibrd::faults
