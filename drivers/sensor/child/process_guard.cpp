// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/process_guard.hpp"

#include <sys/prctl.h>
#include <unistd.h>

#include <atomic>
#include <csignal>

namespace calibrd {
namespace {

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "written by a signal handler");
constexpr unsigned kSecondsToEnd = 1;

extern "C" void on_stop_signal(int) {
  stop_requested = true;
  ::alarm(kSecondsToEnd);
}

}  // namespace

bool end_with_parent(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  return ::getppid() == parent;
}

void install_stop_signal() {
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  ::sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &action, nullptr);
}

bool is_stop_requested() { return stop_requested; }

void limit_time_to_end() { ::alarm(kSecondsToEnd); }

}  // namespace calibrd
