// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/sensor/transport/child_protocol.hpp"
#include "drivers/sensor/transport/sensor_error.hpp"

extern char** environ;

namespace calibrd {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

fs::path program_path(const SensorProcessSettings& settings) {
  if (!settings.program.empty()) return settings.program;
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path() / "calibrd-sensor";
}

/// The daemon's configuration may hold secrets and comes as CALIBRD_SECTION__KEY; the service manager's
/// socket is not the child's either.
bool is_withheld(std::string_view variable) {
  const std::string_view name = variable.substr(0, variable.find('='));
  return (name.starts_with("CALIBRD_") && name.find("__") != std::string_view::npos) ||
         name == "NOTIFY_SOCKET" || name == "WATCHDOG_USEC" || name == "WATCHDOG_PID";
}

/// OpenNI2 finds its drivers beside its library, as the loader names that: the library path chooses both.
Strings environment(const fs::path& openni_directory) {
  constexpr std::string_view kLibraryPath = "LD_LIBRARY_PATH=";
  std::string library_path = openni_directory.string();
  Strings variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view variable(*entry);
    if (is_withheld(variable)) continue;
    if (!openni_directory.empty() && variable.starts_with(kLibraryPath))
      library_path.append(":").append(variable.substr(kLibraryPath.size()));
    else
      variables.emplace_back(variable);
  }
  if (!openni_directory.empty()) variables.push_back(std::string(kLibraryPath) + library_path);
  return variables;
}

std::vector<char*> pointers(Strings& strings) {
  std::vector<char*> result;
  for (std::string& text : strings) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

/// A copy whose number cannot collide with the fixed ones of the child.
FileDescriptor copy_above_fixed(int fd) {
  return FileDescriptor(::fcntl(fd, F_DUPFD_CLOEXEC, kFirstUnusedFd + 10));
}

/// By number: the C++ declaration of pidfd_open in glibc 2.36 lacks its extern "C".
FileDescriptor open_process(pid_t id) {
  return FileDescriptor(static_cast<int>(::syscall(SYS_pidfd_open, id, 0)));
}

class SpawnActions {
 public:
  SpawnActions() {
    ::posix_spawn_file_actions_init(&files_);
    ::posix_spawnattr_init(&attributes_);
  }
  ~SpawnActions() {
    ::posix_spawnattr_destroy(&attributes_);
    ::posix_spawn_file_actions_destroy(&files_);
  }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  void set_descriptors(int messages, int ring, int wake) {
    ::posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files_, STDERR_FILENO,
                                       STDOUT_FILENO);  // drivers chat; stdout is the daemon's
    ::posix_spawn_file_actions_adddup2(&files_, messages, kMessageFd);
    ::posix_spawn_file_actions_adddup2(&files_, ring, kRingFd);
    ::posix_spawn_file_actions_adddup2(&files_, wake, kWakeFd);
    ::posix_spawn_file_actions_addclosefrom_np(&files_, kFirstUnusedFd);
  }

  /// Signals as a fresh process has them, and a group of its own: a Ctrl-C at the terminal is the daemon's.
  void set_signals() {
    sigset_t none, all;
    ::sigemptyset(&none);
    ::sigfillset(&all);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setsigdefault(&attributes_, &all);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(&attributes_,
                               POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }

  int spawn(pid_t& id, const fs::path& program, Strings& arguments, Strings& variables) const {
    return ::posix_spawn(&id, program.c_str(), &files_, &attributes_, pointers(arguments).data(),
                         pointers(variables).data());
  }

 private:
  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

Strings command_line(const SensorProcessSettings& settings, const fs::path& program) {
  Strings arguments{program.string(), std::string(kParentArgument) + std::to_string(::getpid())};
  for (auto& argument : to_arguments(settings.stream)) arguments.push_back(std::move(argument));
  return arguments;
}

}  // namespace

Result<ChildProcess> ChildProcess::spawn(const SensorProcessSettings& settings, int ring_fd, int wake_fd) {
  std::array<int, 2> pair{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()) != 0)
    return system_error("socket pair");
  FileDescriptor ours(pair[0]), theirs(pair[1]);
  const auto messages = copy_above_fixed(theirs.get()), ring = copy_above_fixed(ring_fd),
             wake = copy_above_fixed(wake_fd);
  if (!messages || !ring || !wake) return system_error("file descriptors");

  SpawnActions actions;
  actions.set_descriptors(messages.get(), ring.get(), wake.get());
  actions.set_signals();
  const fs::path program = program_path(settings);
  auto arguments = command_line(settings, program);
  auto variables = environment(settings.openni_directory);
  pid_t id = 0;
  if (const int failed = actions.spawn(id, program, arguments, variables); failed != 0)
    return sensor_error(SensorError::program_missing,
                        program.string() + " (" + std::generic_category().message(failed) + ")");
  return ChildProcess(id, open_process(id), std::move(ours));
}

ChildProcess::ChildProcess(pid_t id, FileDescriptor end, FileDescriptor messages)
    : id_(id), end_(std::move(end)), messages_(std::move(messages)) {}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : id_(std::exchange(other.id_, 0)), end_(std::move(other.end_)), messages_(std::move(other.messages_)) {}

ChildProcess::~ChildProcess() {
  constexpr std::chrono::milliseconds kMoment(200);
  if (id_ == 0 || reap()) return;
  signal(SIGKILL);
  pollfd ended{end_.get(), POLLIN, 0};
  ::poll(&ended, 1, static_cast<int>(kMoment.count()));
  reap();
}

void ChildProcess::signal(int number) {
  if (id_ != 0) ::kill(id_, number);
}

std::optional<ProcessEnd> ChildProcess::reap() {
  int status = 0;
  const pid_t ended = ::waitpid(id_, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return std::nullopt;
  id_ = 0;
  if (ended < 0) return ProcessEnd{};  // somebody else in this process waited for it
  if (WIFSIGNALED(status)) return ProcessEnd{true, WTERMSIG(status)};
  return ProcessEnd{false, WEXITSTATUS(status)};
}

std::variant<ChildProcess::Nothing, ChildProcess::Garbled, SensorMessage> ChildProcess::receive() {
  std::array<std::byte, kMaxSensorMessage> bytes;
  const ssize_t length = ::recv(messages_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (length <= 0) return Nothing{};
  if (auto message = decode(std::span(bytes).first(static_cast<std::size_t>(length))))
    return std::move(*message);
  return Garbled{};
}

}  // namespace calibrd
