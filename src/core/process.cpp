#include "core/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

extern char** environ;

namespace intaglio {

namespace {

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

// The child's program and surroundings. They are prepared before the child exists, because until execve() it
// shares the host's memory, or has a copy of it in which any lock may be held: it makes system calls only.
struct Plan {
  const char* program;
  char* const* arguments;
  const char* folder;  // null: the host's
  int input, errors;   // descriptors; -1: /dev/null, shared
  bool is_leader;      // leads a process group of its own
  rlim_t memory;       // bytes of address space; 0: no limit
  int failure;         // pipe for the errno of what failed; execve() closes it
  pid_t parent;
};

// Ties the calling child to its parent: whichever way that ends, the kernel kills the child.
void die_with(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // Process-wide: the child's; its parent has ended before
}

// Makes `to` the descriptor `from`, or /dev/null, for the next program.
bool put(int from, int to, int flags) {
  if (from < 0) from = open("/dev/null", flags | O_CLOEXEC);
  if (from == to) return fcntl(to, F_SETFD, 0) == 0;
  return dup2(from, to) == to;  // Process-wide: the child's
}

// A host that ignores or blocks signals must not pass that on, and its handlers must not run in the child.
void reset_signals() {
  struct sigaction action {};
  for (int k = 1; k < NSIG; ++k) {
    if (sigaction(k, nullptr, &action) != 0) continue;  // Process-wide: read
    const bool is_kept =
        action.sa_handler == SIG_DFL || (action.sa_handler == SIG_IGN && k != SIGCHLD && k != SIGPIPE);
    action = {};
    if (!is_kept) sigaction(k, &action, nullptr);  // Process-wide: the child's
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

[[noreturn]] void become(const Plan& plan) {
  die_with(plan.parent);
  const rlimit limit{plan.memory, plan.memory};
  if ((!plan.is_leader || setpgid(0, 0) == 0) && put(plan.input, STDIN_FILENO, O_RDONLY) &&
      (plan.errors < 0 || (put(-1, STDOUT_FILENO, O_WRONLY) && put(plan.errors, STDERR_FILENO, 0))) &&
      (plan.folder == nullptr || chdir(plan.folder) == 0) &&  // Process-wide: the child's
      (plan.memory == 0 || setrlimit(RLIMIT_AS, &limit) == 0)) {
    reset_signals();
    execve(plan.program, plan.arguments, environ);
  }
  const int reason = errno;
  (void)!write(plan.failure, &reason, sizeof reason);
  _exit(127);  // Process-wide: the child's
}

// A child that runs the program as a child of its own and writes how that ended to a pipe. It keeps all
// signals blocked, so that it outlives a program that handles one.
[[noreturn]] void supervise(Plan plan, int status_pipe) {
  die_with(plan.parent);
  setpgid(0, 0);
  struct sigaction standard {};
  sigaction(SIGCHLD, &standard, nullptr);  // Process-wide: the child's
  plan.is_leader = false;
  plan.parent = getpid();  // Not in a name
  const pid_t id = vfork();
  if (id == 0) become(plan);
  int status = id < 0 ? errno : 0;
  if (id < 0) (void)!write(plan.failure, &status, sizeof status);
  // It has no use for copies of the host's descriptors, whose other ends would never see them closed.
  dup2(status_pipe, STDIN_FILENO);  // Process-wide: the child's
  close_range(STDIN_FILENO + 1, ~0u, 0);
  if (id > 0 && waitpid(id, &status, 0) == id) (void)!write(STDIN_FILENO, &status, sizeof status);
  _exit(0);  // Process-wide: the child's
}

// Starts the child; its id, or -1 with an errno. No handler of the host's may run in it.
pid_t start_child(const Plan& plan, int status_pipe) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t id = status_pipe >= 0 ? _Fork() : vfork();
  if (id == 0) {
    if (status_pipe >= 0) supervise(plan, status_pipe);
    become(plan);
  }
  const int reason = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = reason;
  return id;
}

// The children that have not been reaped. Never destroyed: it is used while the program ends.
struct Running {
  std::mutex mutex;
  std::vector<pid_t> ids;
};

Running& running() {
  static Running& all = *new Running;
  return all;
}

// Reads a number that another process writes to a pipe; the count of bytes is 0 where it has closed its end.
ssize_t read_fully(int pipe, int& number) {
  ssize_t count = 0;
  while ((count = read(pipe, &number, sizeof number)) < 0 && errno == EINTR) {
  }
  return count;
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

}  // namespace

Result<Process> Process::start(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments, const SpawnOptions& options) {
  Process out;
  out.name_ = program.filename().string();
  const auto failed = [&](int reason) {
    return tl::unexpected(out.error(fmt::format("cannot be started: {}", std::strerror(reason))));
  };
  Descriptor failure_from, failure_to, status_from, status_to;
  const auto make_pipe = [](Descriptor& from, Descriptor& to) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return false;
    from.number = ends[0];
    to.number = ends[1];
    return true;
  };
  if (!options.share_output && (out.errors_ = memfd_create("stderr", MFD_CLOEXEC)) < 0) return failed(errno);
  if (!make_pipe(failure_from, failure_to)) return failed(errno);
  if (children_are_discarded() && !make_pipe(status_from, status_to)) return failed(errno);
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const Plan plan{program.c_str(),
                  argv.data(),
                  options.folder.empty() ? nullptr : options.folder.c_str(),
                  options.input,
                  out.errors_,
                  true,
                  rlim_t(std::max(0.0, options.memory_mb) * 1048576),
                  failure_to.number,
                  getpid()};                    // Not in a name
  const std::lock_guard lock(running().mutex);  // until it has a group that kill_all_processes() can kill
  const pid_t id = start_child(plan, status_to.number);
  if (id < 0) return failed(errno);
  close(failure_to.release());
  int reason = 0;
  const bool is_running = read_fully(failure_from.number, reason) == 0;
  if (!is_running) {
    while (waitpid(id, nullptr, 0) < 0 && errno == EINTR) {
    }
    return failed(reason);
  }
  out.id_ = id;
  running().ids.push_back(id);
  out.status_ = status_from.release();
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
  std::swap(failure_, other.failure_);
}

Error Process::error(const std::string& what) const {
  const std::string line = errors_ >= 0 ? last_line(errors_) : "";
  return {name_, line.empty() ? what : what + ": " + line, ""};
}

void Process::send(int signal) const {
  if (id_ > 0) ::kill(-id_, signal);
}

// Whether the child has ended; then failure_ is set. Before the child is reaped its id, and with it the
// group's, cannot be taken by another process.
bool Process::reap(bool block) {
  if (id_ < 0) return true;
  int status = 0;
  bool is_known = false;
  if (status_ >= 0) {
    pollfd ready{status_, POLLIN, 0};
    int count = 0;
    while ((count = ::poll(&ready, 1, block ? -1 : 0)) < 0 && errno == EINTR) {
    }
    if (count == 0) return false;
    // Where the supervisor is silent it was killed, and the program with it.
    if (read_fully(status_, status) != sizeof status) status = SIGKILL;
    is_known = true;
  } else {
    siginfo_t info{};
    int result = 0;
    while ((result = waitid(P_PID, id_t(id_), &info, WEXITED | WNOWAIT | (block ? 0 : WNOHANG))) < 0 &&
           errno == EINTR) {
    }
    if (result == 0 && info.si_pid == 0) return false;
  }
  ::kill(-id_, SIGKILL);
  {
    const std::lock_guard lock(running().mutex);
    std::erase(running().ids, id_);
  }
  pid_t reaped = -1;
  int unused = 0;
  while ((reaped = waitpid(id_, is_known ? &unused : &status, 0)) < 0 && errno == EINTR) {
  }
  if (!is_known && reaped != id_) {  // a handler of the host's was faster
    failure_ = error(fmt::format("ended, but its exit status is unavailable ({})", std::strerror(errno)));
  } else if (WIFSIGNALED(status)) {
    failure_ = error(fmt::format("crashed ({})", strsignal(WTERMSIG(status))));
  } else if (WEXITSTATUS(status) != 0) {
    failure_ = error(fmt::format("ended with code {}", WEXITSTATUS(status)));
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

void kill_all_processes() {
  running().mutex.lock();  // and never unlocks it
  for (const pid_t id : running().ids) ::kill(-id, SIGKILL);
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
  for (const pid_t id : running().ids) {
    siginfo_t info{};
    while (waitid(P_PID, id_t(id), &info, WEXITED | WNOWAIT | WNOHANG) == 0 && info.si_pid == 0 &&
           std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace intaglio
