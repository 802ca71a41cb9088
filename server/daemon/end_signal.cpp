// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/end_signal.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <thread>

namespace calibrd {

EndSignal::EndSignal() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGTERM);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

int EndSignal::wait() const {
  int number = 0;
  while (sigwait(&signals_, &number) != 0) continue;
  return number;
}

void EndSignal::end_within(std::chrono::milliseconds patience) {
  std::thread([patience] {
    std::this_thread::sleep_for(patience);
    spdlog::warn("something would not end in time; ending without it");
    _exit(0);
  }).detach();
}

}  // namespace calibrd
