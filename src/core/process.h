// Child processes: the one place that starts programs.
//
// A child never outlives its parent: the kernel kills it when the thread that started it ends, whichever way
// that or the whole process ends (PR_SET_PDEATHSIG; a program that is setuid or changes its credentials is
// exempt). So start a child from a thread that outlives it. The child leads a process group of its own, which
// Ctrl-C does not reach, and the group is killed as a whole once the child has ended.
//
// The exit status is right whatever the host does with SIGCHLD: where it ignores that signal the kernel
// discards the status of its children, so the program then runs below a fork that writes the status to a
// pipe. No signal handler, signal mask or environment of the host is changed. Linux; thread-safe, but each
// Process belongs to one thread at a time.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intaglio/error.h"

namespace intaglio {

struct SpawnOptions {
  std::filesystem::path folder;  // working directory; empty: the host's
  int input = -1;                // file descriptor that becomes standard input; -1: /dev/null
  // The child writes to the host's standard output and error. Otherwise its output is discarded, and the last
  // line of its standard error becomes part of the error when it fails.
  bool share_output = false;
  double memory_mb = 0;  // limit on its address space; 0: none
};

class Process {
 public:
  static Result<Process> start(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments, const SpawnOptions& options = {});
  Process(Process&& other) noexcept { swap(other); }
  Process& operator=(Process&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Process();  // kills the child if it still runs

  // Blocks until the child has ended. Succeeds when its exit code was 0; otherwise the error names the
  // program and says what it did instead: "crashed (Segmentation fault)", "ended with code 3: out of memory".
  Result<void> wait();
  // The same without blocking; empty while the child runs.
  std::optional<Result<void>> poll();
  void terminate() const { send(SIGTERM); }
  void kill() const { send(SIGKILL); }

 private:
  Process() = default;
  void swap(Process& other);
  void send(int signal) const;
  bool reap(bool block);
  Error error(const std::string& what) const;

  std::string name_;
  pid_t id_ = -1;                 // -1: ended, or moved from
  int status_ = -1;               // read end of the status pipe; -1: the host reaps the child itself
  int errors_ = -1;               // file that holds the child's standard error; -1: shared
  std::optional<Error> failure_;  // how it ended, unless well
};

struct ProcessLimits {
  double seconds = 60;
  double memory_mb = 4000;  // of address space; 0: no limit
};

// Runs a program in `folder` with limits on time and memory: for work that may crash, hang or exhaust memory.
// Blocks. Errors as Process::wait(), and "took more than 60 s".
Result<void> run_limited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const std::filesystem::path& folder, const ProcessLimits& limits);

// Kills every child, and returns when they have ended, or after 0.1 s. For a program that ends next, in
// whatever state its threads are: from then on no thread that starts a child or waits for one returns.
void kill_all_processes();

}  // namespace intaglio
