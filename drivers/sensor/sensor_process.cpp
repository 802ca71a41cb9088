// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/sensor_process.hpp"

#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <new>
#include <system_error>

#include "drivers/sensor/child_process.hpp"
#include "drivers/sensor/supervisor_machine.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;

constexpr auto kPulsePeriod = 100ms;  // how often a running child's heartbeat is looked at
constexpr auto kLongestEnd = 400ms;   // of a process at the destructor, before it is killed
constexpr auto kLongestStop = 900ms;  // a process in an uninterruptible call is left to the system then

RingGeometry geometry_of(const StreamRequest& request) {
  return {.width = request.width, .height = request.height, .with_image = request.image != ImageKind::none};
}

int milliseconds_until(Clock::time_point when) {
  const auto left = std::chrono::ceil<milliseconds>(when - Clock::now());
  return static_cast<int>(std::clamp<milliseconds>(left, 0ms, 1h).count());
}

SensorHealth health_of(const SupervisorMachine& machine, const std::string& id) {
  SensorHealth health;
  using State = SensorHealth::State;
  health.state = machine.is_streaming() ? State::streaming
                 : machine.failure()    ? State::lost
                                        : State::starting;
  if (health.state == State::lost)
    health.reason = (id.empty() ? "" : "sensor " + id + ": ") + machine.failure()->message();
  health.restarts = machine.restarts();
  if (machine.stream()) {
    health.device = machine.stream()->device;
    health.notice = machine.stream()->notice;
  }
  return health;
}

}  // namespace

Result<std::unique_ptr<SensorProcess>> SensorProcess::start(SensorProcessSettings settings) {
  if (auto checked = check(settings); !checked) return checked.error();
  FileDescriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      stop(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake || !stop) return system_error("event descriptors");
  std::unique_ptr<SensorProcess> process(
      new SensorProcess(std::move(settings), std::move(wake), std::move(stop)));
  try {
    process->thread_ = std::thread([self = process.get()] { self->supervise(); });
  } catch (const std::system_error& failure) {
    return sensor_error(SensorError::system_refused, std::string("thread (") + failure.what() + ")");
  }
  return process;
}

SensorProcess::SensorProcess(SensorProcessSettings settings, FileDescriptor wake, FileDescriptor stop)
    : settings_(std::move(settings)), wake_(std::move(wake)), stop_(std::move(stop)) {}

SensorProcess::~SensorProcess() {
  ::eventfd_write(stop_.get(), 1);
  if (thread_.joinable()) thread_.join();
}

std::optional<DepthFrame> SensorProcess::next(milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  while (true) {
    if (auto frame = take()) return frame;
    if (Clock::now() >= deadline) return std::nullopt;
    pollfd wake{wake_.get(), POLLIN, 0};
    eventfd_t count = 0;
    if (::poll(&wake, 1, milliseconds_until(deadline)) > 0) ::eventfd_read(wake_.get(), &count);
  }
}

std::optional<DepthFrame> SensorProcess::take() {
  {
    const std::lock_guard lock(mutex_);
    if (reading_ != ring_) child_sequence_.reset();
    reading_ = ring_;
  }
  if (!reading_) return std::nullopt;
  auto frame = reading_->take();
  if (frame) number(*frame);
  return frame;
}

void SensorProcess::number(DepthFrame& frame) {
  std::uint64_t advance = 1;
  if (child_sequence_ && frame.sequence > *child_sequence_) advance = frame.sequence - *child_sequence_;
  child_sequence_ = frame.sequence;
  frame.sequence = sequence_ ? *sequence_ + advance : 0;
  sequence_ = frame.sequence;
  frame.stamp = std::min(frame.stamp, Clock::now());
  ++frames_;
  frames_lost_ += advance - 1;
  const std::lock_guard lock(mutex_);
  health_.state = SensorHealth::State::streaming;
  health_.reason.clear();
}

SensorHealth SensorProcess::health() const {
  const std::lock_guard lock(mutex_);
  SensorHealth health = health_;
  health.frames = frames_;
  health.frames_lost = frames_lost_;
  return health;
}

void SensorProcess::supervise() {
  auto timeouts = settings_.timeouts;
  timeouts.end = std::min<milliseconds>(timeouts.end, kLongestEnd);
  SupervisorMachine machine(timeouts);
  std::optional<ChildProcess> child;
  std::optional<Clock::time_point> give_up_at;
  // One time for looking and judging: time this thread lay idle in between must not look like a silent
  // child's.
  auto now = Clock::now();
  while (!give_up_at || (!machine.is_finished() && Clock::now() < *give_up_at)) {
    try {
      obey(machine, child, now);
      wait(machine, child);
      now = Clock::now();
      observe(machine, child, now);
    } catch (const std::bad_alloc&) {
      start_over(machine, child);
    }
    if (!give_up_at && is_stop_requested()) {
      machine.stop();
      give_up_at = now + kLongestStop;
    }
  }
}

/// What was under way is not known any more; so the process is ended, and started anew after the usual pause.
/// Takes no memory.
void SensorProcess::start_over(SupervisorMachine& machine, std::optional<ChildProcess>& child) const {
  child.reset();
  machine.on_spawn_failed(sensor_error(SensorError::system_refused), Clock::now());
}

void SensorProcess::obey(SupervisorMachine& machine, std::optional<ChildProcess>& child,
                         Clock::time_point now) {
  switch (machine.next(now)) {
    case SupervisorMachine::Order::spawn:
      return spawn(machine, child);
    case SupervisorMachine::Order::terminate:
      if (child) child->signal(SIGTERM);
      return;
    case SupervisorMachine::Order::kill:
      if (child) child->signal(SIGKILL);
      return;
    case SupervisorMachine::Order::wait:
      return;
  }
}

/// Each process gets a ring of its own, so that a dying one cannot write into its successor's.
void SensorProcess::spawn(SupervisorMachine& machine, std::optional<ChildProcess>& child) {
  const auto geometry = geometry_of(settings_.stream);
  const auto memory = create_frame_ring(geometry);
  if (!memory) return machine.on_spawn_failed(memory.error(), Clock::now());
  auto ring = FrameRingReader::attach(memory->get(), geometry);
  if (!ring) return machine.on_spawn_failed(ring.error(), Clock::now());
  auto reader = std::make_shared<FrameRingReader>(*std::move(ring));
  auto spawned = ChildProcess::spawn(settings_, memory->get(), wake_.get());
  if (!spawned) return machine.on_spawn_failed(spawned.error(), Clock::now());
  child.emplace(std::move(*spawned));
  machine.on_spawned(Clock::now());
  const std::lock_guard lock(mutex_);
  ring_ = std::move(reader);
}

void SensorProcess::wait(const SupervisorMachine& machine, const std::optional<ChildProcess>& child) const {
  if (machine.is_finished() && is_stop_requested()) return;
  std::array<pollfd, 3> events{pollfd{stop_.get(), POLLIN, 0},
                               pollfd{child ? child->end_fd() : -1, POLLIN, 0},
                               pollfd{child ? child->message_fd() : -1, POLLIN, 0}};
  const auto far = Clock::now() + (child ? milliseconds(kPulsePeriod) : milliseconds(1h));
  if (is_stop_requested()) events[0].fd = -1;
  ::poll(events.data(), events.size(), milliseconds_until(std::min(machine.due().value_or(far), far)));
}

void SensorProcess::observe(SupervisorMachine& machine, std::optional<ChildProcess>& child,
                            Clock::time_point now) {
  if (child) {
    // Whether it has ended is asked before its messages are read: what it said last is then among them.
    const auto end = child->reap();
    for (auto received = child->receive(); !std::holds_alternative<ChildProcess::Nothing>(received);
         received = child->receive()) {
      const auto* message = std::get_if<SensorMessage>(&received);
      machine.on_message(
          message ? *message : SensorFailure{SensorError::version_mismatch, "unreadable message"}, now);
    }
    if (end) {
      machine.on_end(*end, now);
      child.reset();
    }
  }
  // The pulse is read under the lock, so that health() never goes back from a frame next() has delivered.
  const std::lock_guard lock(mutex_);
  if (child && ring_) machine.on_pulse({ring_->heartbeat(), ring_->published()}, now);
  health_ = health_of(machine, settings_.id);
}

bool SensorProcess::is_stop_requested() const {
  pollfd stop{stop_.get(), POLLIN, 0};
  return ::poll(&stop, 1, 0) > 0;
}

}  // namespace calibrd
