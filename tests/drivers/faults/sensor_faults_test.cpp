// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Every call that looks after a sensor's process fails once, in turn: it says so, and the frames come back by
// themselves.
#include <sys/wait.h>

#include <cerrno>
#include <future>
#include <new>

#include "drivers/sensor/transport/sensor_error.hpp"
#include "tests/drivers/faults/call_faults.hpp"
#include "tests/drivers/robot/state_peer.hpp"
#include "tests/drivers/sensor/sensor_test_support.hpp"

namespace calibrd::fake {
namespace {

struct Fault {
  faults::Call call;
  int error;
  int most = 6;
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << name_of(fault.call) << ' ' << fault.error; }

class SensorCalls : public SensorTest, public ::testing::WithParamInterface<Fault> {
 protected:
  /// False: there are not that many such calls.
  bool survives(int n) {
    write(Control{});
    faults::fail(GetParam().call, n, GetParam().error);
    if (starts()) {
      EXPECT_TRUE(frame());
      write(Control{.crash_after = 3});
      EXPECT_TRUE(reach([](const SensorHealth& health) { return health.restarts > 0; }));
      write(Control{});
      EXPECT_TRUE(reach_streaming() && frame()) << sensor_->health().reason;
    }
    const bool has_failed = faults::heal();
    sensor_.reset();
    return has_failed;
  }

 private:
  /// On a thread whose calls count. Where it does not start, it says why.
  bool starts() {
    auto starting = std::async(std::launch::async, [] { return SensorProcess::start(settings()); });
    try {
      auto started = starting.get();
      if (started) {
        sensor_ = std::move(*started);
      } else {
        EXPECT_EQ(started.error().code, SensorError::system_refused) << started.error().message();
      }
    } catch (const std::bad_alloc&) {
      EXPECT_EQ(GetParam().call, faults::Call::allocation);
    }
    return sensor_ != nullptr;
  }
};

TEST_P(SensorCalls, EachMayFailAndTheFramesComeBack) {
  const faults::Bystander the_test;
  const std::size_t descriptors = open_descriptors();
  int n = 1;
  while (n <= GetParam().most && survives(n)) {
    ASSERT_FALSE(HasFailure()) << "call number " << n;
    ++n;
  }
  EXPECT_FALSE(HasFailure()) << "call number " << n;
  EXPECT_GT(n, 1) << "there was nothing to fail";
  EXPECT_EQ(open_descriptors(), descriptors);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process is left";
}

using faults::Call;
INSTANTIATE_TEST_SUITE_P(One, SensorCalls,
                         ::testing::Values(Fault{Call::eventfd, EMFILE}, Fault{Call::memfd_create, EMFILE},
                                           Fault{Call::ftruncate, ENOMEM}, Fault{Call::fstat, EIO},
                                           Fault{Call::fcntl, EMFILE, 12}, Fault{Call::mmap, ENOMEM},
                                           Fault{Call::socketpair, EMFILE}, Fault{Call::posix_spawn, EAGAIN},
                                           Fault{Call::poll, ENOMEM, 4}, Fault{Call::recv, ENOMEM, 4},
                                           Fault{Call::waitpid, EINTR, 4},
                                           Fault{Call::pthread_create, EAGAIN},
                                           Fault{Call::allocation, ENOMEM, 60}),
                         [](const auto& info) { return std::string(name_of(info.param.call)); });

}  // namespace
}  // namespace calibrd::fake
