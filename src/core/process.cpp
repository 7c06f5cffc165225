#include "core/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <thread>
#include <utility>

extern char** environ;

namespace intaglio {

namespace {

constexpr int status_descriptor = 3;  // in the shell

// A file descriptor that is closed at the end of the scope.
struct Descriptor {
  int number = -1;
  explicit Descriptor(int n = -1) : number(n) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) close(number);
  }
  int release() { return std::exchange(number, -1); }
};

// Whether the kernel discards the exit status of the host's children.
bool children_are_discarded() {
  struct sigaction action {};
  if (sigaction(SIGCHLD, nullptr, &action) != 0) return false;  // Process-wide: read, not changed
  return action.sa_handler == SIG_IGN || (action.sa_flags & SA_NOCLDWAIT) != 0;
}

struct SpawnSettings {
  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};

  SpawnSettings(const SpawnOptions& options, bool own_group, int errors, int status) {
    posix_spawn_file_actions_init(&actions);
    if (options.input >= 0) {
      posix_spawn_file_actions_adddup2(&actions, options.input, STDIN_FILENO);
    } else {
      posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    }
    if (!options.share_output) {
      posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
      posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
    }
    if (status >= 0) posix_spawn_file_actions_adddup2(&actions, status, status_descriptor);
    if (!options.folder.empty()) posix_spawn_file_actions_addchdir_np(&actions, options.folder.c_str());
    posix_spawnattr_init(&attributes);
    // A host that ignores or blocks signals must not pass that on.
    sigset_t defaults, none;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGCHLD);
    sigaddset(&defaults, SIGPIPE);
    sigemptyset(&none);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, short(POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK |
                                                (own_group ? POSIX_SPAWN_SETPGROUP : 0)));
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
};

// The command line: of the program, or of a shell that runs it and writes its status to a pipe.
std::vector<std::string> command(const std::filesystem::path& program,
                                 const std::vector<std::string>& arguments, double memory_mb,
                                 bool below_shell) {
  std::vector<std::string> words;
  if (below_shell) {
    std::error_code ignored;
    const bool is_self = program == "/proc/self/exe";  // which would be the shell
    const std::string limit = memory_mb > 0 ? fmt::format("ulimit -v {:.0f}; ", memory_mb * 1024) : "";
    words = {"/bin/sh", "-c", limit + "\"$@\" 3>&-; echo $? >&3", "sh",
             is_self ? std::filesystem::read_symlink(program, ignored).string() : program.string()};
  } else {
    words = {program.string()};
  }
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

std::string last_line(int file) {
  constexpr std::size_t longest = 300;
  std::string text(longest, '\0');
  const off_t size = lseek(file, 0, SEEK_END);
  const ssize_t count = pread(file, text.data(), text.size(), std::max<off_t>(0, size - off_t(longest)));
  text.resize(std::size_t(std::max<ssize_t>(0, count)));
  while (!text.empty() && std::isspace(std::uint8_t(text.back()))) text.pop_back();
  return text.substr(text.find_last_of('\n') + 1);
}

std::string signal_error(int signal) {
  return fmt::format("crashed ({})", strsignal(signal));
}

std::string code_error(int code) {
  return fmt::format("ended with code {}", code);
}

}  // namespace

Result<Process> Process::start(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments, const SpawnOptions& options) {
  Process out;
  out.name_ = program.filename().string();
  const auto failed = [&](int reason) {
    return tl::unexpected(out.error(fmt::format("cannot be started: {}", std::strerror(reason))));
  };
  const bool below_shell = children_are_discarded();
  out.own_group_ = options.own_group || below_shell;  // the shell is not killed alone
  Descriptor errors, status_from, status_to;
  if (!options.share_output) {
    errors.number = memfd_create("stderr", MFD_CLOEXEC);
    if (errors.number < 0) return failed(errno);
  }
  if (below_shell) {
    if (program.is_absolute() && access(program.c_str(), X_OK) != 0) return failed(errno);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return failed(errno);
    status_from.number = ends[0];
    status_to.number = ends[1];
  }
  std::vector<std::string> words = command(program, arguments, options.memory_mb, below_shell);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const SpawnSettings settings(options, out.own_group_, errors.number, status_to.number);
  const int reason = posix_spawn(&out.id_, below_shell ? "/bin/sh" : program.c_str(), &settings.actions,
                                 &settings.attributes, argv.data(), environ);
  if (reason != 0) {
    out.id_ = -1;
    return failed(reason);
  }
  if (options.memory_mb > 0 && !below_shell) {
    const auto bytes = rlim_t(options.memory_mb * 1048576);
    const rlimit limit{bytes, bytes};
    prlimit(out.id_, RLIMIT_AS, &limit, nullptr);
  }
  out.status_ = status_from.release();
  out.errors_ = errors.release();
  return out;
}

Process::~Process() {
  if (id_ > 0) {
    kill();
    reap(true);
  }
  for (const int file : {status_, errors_}) {
    if (file >= 0) close(file);
  }
}

void Process::swap(Process& other) {
  std::swap(name_, other.name_);
  std::swap(id_, other.id_);
  std::swap(status_, other.status_);
  std::swap(errors_, other.errors_);
  std::swap(own_group_, other.own_group_);
  std::swap(failure_, other.failure_);
}

Error Process::error(const std::string& what) const {
  const std::string line = errors_ >= 0 ? last_line(errors_) : "";
  return {name_, line.empty() ? what : what + ": " + line, ""};
}

void Process::kill() {
  if (id_ > 0) ::kill(own_group_ ? -id_ : id_, SIGKILL);
}

// Whether the child has ended; then failure_ is set. Before the child is reaped its id, and with it the
// group's, cannot be taken by another process.
bool Process::reap(bool block) {
  if (id_ < 0) return true;
  if (status_ >= 0) {
    pollfd ready{status_, POLLIN, 0};
    int count = 0;
    while ((count = ::poll(&ready, 1, block ? -1 : 0)) < 0 && errno == EINTR) {
    }
    if (count == 0) return false;
    char text[16] = {};
    const ssize_t size = read(status_, text, sizeof text - 1);
    const int code = std::atoi(text);
    if (own_group_) ::kill(-id_, SIGKILL);
    if (size <= 0) {
      failure_ = error(signal_error(SIGKILL));
    } else if (code > 128) {  // as shells report signals
      failure_ = error(signal_error(code - 128));
    } else if (code != 0) {
      failure_ = error(code_error(code));
    }
    id_ = -1;
    return true;
  }
  siginfo_t info{};
  int result = 0;
  while ((result = waitid(P_PID, id_t(id_), &info, WEXITED | WNOWAIT | (block ? 0 : WNOHANG))) < 0 &&
         errno == EINTR) {
  }
  if (result == 0 && info.si_pid == 0) return false;
  if (own_group_) ::kill(-id_, SIGKILL);
  int status = 0;
  pid_t reaped = -1;
  while ((reaped = waitpid(id_, &status, 0)) < 0 && errno == EINTR) {
  }
  if (reaped != id_) {  // a handler of the host's was faster
    failure_ = error(fmt::format("ended, but its exit status is unavailable ({})", std::strerror(errno)));
  } else if (WIFSIGNALED(status)) {
    failure_ = error(signal_error(WTERMSIG(status)));
  } else if (WEXITSTATUS(status) != 0) {
    failure_ = error(code_error(WEXITSTATUS(status)));
  }
  id_ = -1;
  return true;
}

Result<void> Process::wait() {
  reap(true);
  if (failure_) return tl::unexpected(*failure_);
  return {};
}

std::optional<Result<void>> Process::poll() {
  if (!reap(false)) return std::nullopt;
  return wait();
}

Result<void> run_limited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const std::filesystem::path& folder, const ProcessLimits& limits) {
  SpawnOptions options;
  options.folder = folder;
  options.own_group = true;
  options.memory_mb = limits.memory_mb;
  auto child = Process::start(program, arguments, options);
  if (!child) return tl::unexpected(child.error());
  using std::chrono::steady_clock;
  const auto end = steady_clock::now() + std::chrono::duration<double>(limits.seconds);
  for (auto pause = std::chrono::milliseconds(1);;
       pause = std::min(2 * pause, std::chrono::milliseconds(50))) {
    if (const auto ended = child->poll()) return *ended;
    if (steady_clock::now() > end)
      return fail(program.filename().string(), fmt::format("took more than {:.3g} s", limits.seconds));
    std::this_thread::sleep_for(pause);
  }
}

}  // namespace intaglio
