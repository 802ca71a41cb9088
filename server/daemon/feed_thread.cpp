// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/feed_thread.hpp"

#include <random>

#include "server/live_cell/dated_id.hpp"

namespace calibrd {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(100);

std::string new_run() {
  std::mt19937 random{std::random_device{}()};
  return dated_id(std::chrono::system_clock::now(), random);
}

}  // namespace

FeedThread::FeedThread(api::CellService& service)
    : hub_(new_run()), feed_(service, hub_), thread_([this] { run(); }) {}

FeedThread::~FeedThread() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  ending_.notify_all();
  thread_.join();
}

void FeedThread::run() {
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    lock.unlock();
    feed_.look();
    lock.lock();
    ending_.wait_for(lock, kPeriod, [this] { return is_ending_; });
  }
}

}  // namespace calibrd
