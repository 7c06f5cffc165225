// Work in a process of its own, so that its peak of memory is its own, too.
#pragma once

#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <type_traits>

namespace intaglio::bench {

// A line of /proc/self/status in bytes; 0 where there is none.
inline double status_bytes(const std::string& name) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(name + ":", 0) == 0) return 1024 * std::stod(line.substr(name.size() + 1));
  }
  return 0;
}

// How far the resident set grew at most since construction.
class PeakMemory {
 public:
  PeakMemory() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak is the present from here on
    start_ = status_bytes("VmRSS");
  }
  double bytes() const { return status_bytes("VmHWM") - start_; }

 private:
  double start_ = 0;
};

// Bytes that the program holds, whether or not they were touched.
inline double allocated_bytes() {
  const auto info = mallinfo2();
  return double(info.uordblks) + double(info.hblkhd);
}

// The value of `work()`, computed by a child process; nothing if that ended in another way. Before the
// first thread of this process only.
template <class Work>
auto in_child(const Work& work) -> std::optional<decltype(work())> {
  using Value = decltype(work());
  static_assert(std::is_trivially_copyable_v<Value>);
  int ends[2];
  if (pipe(ends) != 0) return std::nullopt;
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) return std::nullopt;
  if (child == 0) {
    const Value value = work();
    const bool written = write(ends[1], &value, sizeof value) == ssize_t(sizeof value);
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  Value value{};
  const bool complete = read(ends[0], &value, sizeof value) == ssize_t(sizeof value);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!complete || status != 0) return std::nullopt;
  return value;
}

}  // namespace intaglio::bench
