#include "core/process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <cstring>
#include <thread>
#include <fmt/format.h>

extern char** environ;

namespace intaglio {

namespace {

Error complaint(const std::filesystem::path& program, const std::string& what) {
  return {program.filename().string(), what, ""};
}

struct SpawnSettings {
  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};
  explicit SpawnSettings(const std::filesystem::path& folder) {
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    for (const int stream : {1, 2})
      posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
};

}  // namespace

Result<void> run_limited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const std::filesystem::path& folder, const ProcessLimits& limits) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const SpawnSettings settings(folder);
  pid_t child = -1;
  const int failed =
      posix_spawn(&child, program.c_str(), &settings.actions, &settings.attributes, argv.data(), environ);
  if (failed != 0)
    return tl::unexpected(complaint(program, fmt::format("cannot be started: {}", std::strerror(failed))));
  if (limits.memory_mb > 0) {
    const auto bytes = static_cast<rlim_t>(limits.memory_mb * 1048576);
    const rlimit limit{bytes, bytes};
    prlimit(child, RLIMIT_AS, &limit, nullptr);
  }
  using SteadyClock = std::chrono::steady_clock;
  const auto end = SteadyClock::now() + std::chrono::duration<double>(limits.seconds);
  int status = 0;
  pid_t ended = 0;
  for (auto pause = std::chrono::milliseconds(1); (ended = waitpid(child, &status, WNOHANG)) == 0;) {
    if (SteadyClock::now() > end) {
      kill(-child, SIGKILL);
      waitpid(child, &status, 0);
      return tl::unexpected(complaint(program, fmt::format("took more than {:.3g} s", limits.seconds)));
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::milliseconds(50));
  }
  kill(-child, SIGKILL);  // what it may have left behind
  if (ended != child)
    return tl::unexpected(
        complaint(program, fmt::format("ended, but how is not known ({}; does the host ignore SIGCHLD?)",
                                       std::strerror(errno))));
  if (WIFSIGNALED(status))
    return tl::unexpected(complaint(program, fmt::format("crashed ({})", strsignal(WTERMSIG(status)))));
  if (WEXITSTATUS(status) != 0)
    return tl::unexpected(complaint(program, fmt::format("ended with code {}", WEXITSTATUS(status))));
  return {};
}

}  // namespace intaglio
