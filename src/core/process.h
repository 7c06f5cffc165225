// Child processes: the one place that starts programs.
//
// The exit status is right whatever the host does with SIGCHLD: where it ignores that signal the kernel
// discards the status of its children, so the program then runs below a shell that writes the status to a
// pipe. No signal handler, signal mask or environment of the host is changed. POSIX; thread-safe, but each
// Process belongs to one thread at a time.
#pragma once

#include <sys/types.h>

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
  bool own_group = false;  // a process group of its own, killed as a whole once the child has ended
  double memory_mb = 0;    // limit on its address space; 0: none
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
  void kill();

 private:
  Process() = default;
  void swap(Process& other);
  bool reap(bool block);
  Error error(const std::string& what) const;

  std::string name_;
  pid_t id_ = -1;    // -1: ended, or moved from
  int status_ = -1;  // read end of the shell's status pipe; -1: there is no shell
  int errors_ = -1;  // file that holds the child's standard error; -1: shared
  bool own_group_ = false;
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

}  // namespace intaglio
