// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What goes wrong with sensors and their drivers, and that it costs no more than a restart of the child.
#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <csignal>
#include <fstream>

#include "drivers/sensor/transport/sensor_error.hpp"
#include "tests/drivers/sensor/sensor_test_support.hpp"

namespace calibrd::fake {
namespace {

using State = SensorHealth::State;

int open_descriptors() {
  int count = 0;
  DIR* directory = ::opendir("/proc/self/fd");
  while (::readdir(directory) != nullptr) ++count;
  ::closedir(directory);
  return count;
}

/// Whether this process has a child left, alive or zombie.
bool has_children() {
  return !(::waitid(P_ALL, 0, nullptr, WEXITED | WNOHANG | WNOWAIT) != 0 && errno == ECHILD);
}

std::vector<pid_t> children() {
  std::vector<pid_t> ids;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "children");
    for (pid_t id = 0; file >> id;) ids.push_back(id);
  }
  return ids;
}

TEST_F(SensorTest, SaysWhatWasFoundWhenNoDeviceMatches) {
  auto wanted = settings();
  wanted.stream.device = "freenect2://*";
  start(wanted);
  ASSERT_TRUE(reach_loss("no depth sensor matches"));
  const std::string reason = sensor_->health().reason;
  EXPECT_NE(reason.find("freenect2://*"), std::string::npos) << reason;
  EXPECT_NE(reason.find("found: fake://sensor/0"), std::string::npos) << reason;
  EXPECT_NE(reason.find("libFakeSensor.so.0"), std::string::npos) << reason;
  EXPECT_NE(reason.find("docs/sensors.md"), std::string::npos) << reason;
}

TEST_F(SensorTest, TakesUpADeviceThatIsPluggedInLater) {
  write({.devices = 0});
  start(settings());
  ASSERT_TRUE(reach_loss("no depth sensor matches"));
  write({});
  EXPECT_TRUE(reach_streaming());
}

TEST_F(SensorTest, SurvivesUnplugAndReplug) {
  start(settings());
  const auto before = frame();
  ASSERT_TRUE(before);
  write({.devices = 0});
  ASSERT_TRUE(reach_loss("no depth sensor matches"));
  write({});
  std::optional<DepthFrame> after;
  ASSERT_TRUE(reach([&](const SensorHealth&) { return (after = sensor_->next(100ms)).has_value(); }));
  EXPECT_GT(after->sequence, before->sequence);
  EXPECT_GE(sensor_->health().restarts, 1u);
}

TEST_F(SensorTest, SaysThatTheDeviceWasUnplugged) {
  auto wanted = settings();
  wanted.timeouts.restart_min = wanted.timeouts.restart_max = 10min;
  start(wanted);
  ASSERT_TRUE(frame());
  write({.devices = 0});
  EXPECT_TRUE(reach_loss("unplugged"));
}

TEST_F(SensorTest, SurvivesACrashingDriver) {
  write({.crash_after = 5});
  start(settings());
  ASSERT_TRUE(reach_loss("signal 6"));
  write({});
  EXPECT_TRUE(reach_streaming());
  EXPECT_GE(sensor_->health().restarts, 1u);
}

TEST_F(SensorTest, RestartsADriverThatHangsWhileStreaming) {
  auto wanted = settings();
  wanted.timeouts.heartbeat = 500ms;
  start(wanted);
  ASSERT_TRUE(frame());
  write({.hang = "wait"});
  ASSERT_TRUE(reach_loss("stopped answering"));
  write({});
  EXPECT_TRUE(reach_streaming());
}

TEST_F(SensorTest, RestartsADriverThatHangsWhenOpened) {
  for (const char* call : {"create", "open"}) {
    write({.hang = call});
    auto wanted = settings();
    wanted.timeouts.open = 300ms;
    start(wanted);
    ASSERT_TRUE(reach_loss("opening the device")) << call;
  }
  // Once it opens again, it must do so within the time given.
  write({});
  auto wanted = settings();
  start(wanted);
  EXPECT_TRUE(reach_streaming());
}

TEST_F(SensorTest, RestartsADeviceThatFallsSilent) {
  auto wanted = settings();
  wanted.timeouts.silence = 500ms;
  start(wanted);
  ASSERT_TRUE(frame());
  write({.silent = 1});
  ASSERT_TRUE(reach_loss("no frames"));
  write({});
  EXPECT_TRUE(reach_streaming());
}

TEST_F(SensorTest, RefusesFramesOfAnotherSize) {
  write({.frame_width = kWidth / 2});
  start(settings());
  EXPECT_TRUE(reach_loss("a frame of 32x48 instead of 64x48"));
  EXPECT_EQ(sensor_->health().frames, 0u);
}

TEST_F(SensorTest, ListsTheModesWhenTheOneAskedForIsNotOffered) {
  auto wanted = settings();
  wanted.stream.width = 512;
  wanted.stream.height = 424;
  start(wanted);
  EXPECT_TRUE(reach_loss("64x48 at 100 (depth 1 mm)"));
}

TEST_F(SensorTest, SaysThatTheProgramIsMissing) {
  auto wanted = settings();
  wanted.program = "/nonexistent/calibrd-sensor";
  start(wanted);
  EXPECT_TRUE(reach_loss("/nonexistent/calibrd-sensor"));
}

TEST_F(SensorTest, SurvivesAProgramThatIsNoSensor) {
  auto wanted = settings();
  wanted.program = "/bin/false";
  start(wanted);
  EXPECT_TRUE(reach_loss("ended with status 1"));
}

TEST_F(SensorTest, RefusesSettingsThatCannotWork) {
  auto wanted = settings();
  wanted.stream.width = 0;
  const auto started = SensorProcess::start(wanted);
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, SensorError::invalid_settings);
  EXPECT_NE(started.error().message().find("width = 0"), std::string::npos);
}

TEST_F(SensorTest, EndsWithinASecondFromEveryState) {
  struct Case {
    const char* name;
    Control control;
    bool has_frames;
  };
  const Case cases[] = {{"streaming", {}, true},
                        {"no device", {.devices = 0}, false},
                        {"hanging in create", {.hang = "create"}, false},
                        {"hanging in open", {.hang = "open"}, false},
                        {"hanging in close", {.hang = "close"}, true},
                        {"silent", {.silent = 1}, false}};
  const int before = open_descriptors();
  for (const Case& test : cases) {
    write(test.control);
    start(settings());
    if (test.has_frames) {
      ASSERT_TRUE(frame()) << test.name;
    } else {
      ASSERT_TRUE(reach([](const SensorHealth&) { return !children().empty(); })) << test.name;
    }
    const auto began = Clock::now();
    sensor_.reset();
    EXPECT_LT(Clock::now() - began, 1s) << test.name;
    EXPECT_FALSE(has_children()) << test.name;
    EXPECT_EQ(open_descriptors(), before) << test.name;
  }
}

TEST_F(SensorTest, LeaksNoDescriptorsOverRestarts) {
  write({.devices = 0});
  start(settings());
  ASSERT_TRUE(reach([](const SensorHealth& health) { return health.restarts >= 2; }));
  const int early = open_descriptors();
  ASSERT_TRUE(reach([](const SensorHealth& health) { return health.restarts >= 8; }));
  EXPECT_LE(open_descriptors(), early + 3);  // one process's pidfd and socket come and go
}

TEST_F(SensorTest, TheChildInheritsNothing) {
  const FileDescriptor zero(::open("/dev/zero", O_RDONLY | O_CLOEXEC));
  const FileDescriptor secret(::fcntl(zero.get(), F_DUPFD, 100));  // without close-on-exec
  ::setenv("CALIBRD_HTTP__TOKEN", "secret", 1);
  start(settings());
  ASSERT_TRUE(frame());
  const auto ids = children();
  ASSERT_EQ(ids.size(), 1u);
  const auto process = std::filesystem::path("/proc") / std::to_string(ids[0]);
  for (const auto& entry : std::filesystem::directory_iterator(process / "fd"))
    EXPECT_NE(std::filesystem::read_symlink(entry), "/dev/zero");
  std::ifstream file(process / "environ");
  const std::string environment((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(environment.find("LD_LIBRARY_PATH="), std::string::npos);
  EXPECT_EQ(environment.find("secret"), std::string::npos);
}

/// A daemon killed outright takes its sensor processes along.
TEST_F(SensorTest, TheChildDiesWithTheDaemon) {
  int channel[2];
  ASSERT_EQ(::pipe(channel), 0);
  const pid_t daemon = ::fork();
  if (daemon == 0) {
    auto sensor = SensorProcess::start(settings());
    pid_t child = 0;
    if (sensor && (*sensor)->next(20s)) child = children().at(0);
    (void)!::write(channel[1], &child, sizeof(child));
    while (true) ::pause();
  }
  pid_t child = 0;
  ASSERT_EQ(::read(channel[0], &child, sizeof(child)), static_cast<ssize_t>(sizeof(child)));
  ASSERT_GT(child, 0);
  const int child_fd = static_cast<int>(::syscall(SYS_pidfd_open, child, 0));
  ASSERT_GE(child_fd, 0);
  ::kill(daemon, SIGKILL);
  pollfd ended{child_fd, POLLIN, 0};
  EXPECT_EQ(::poll(&ended, 1, 5000), 1);
  ::waitpid(daemon, nullptr, 0);
}

}  // namespace
}  // namespace calibrd::fake
