#include "command/stop.h"

#include <fmt/format.h>
#include <poll.h>
#include <semaphore.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <string>
#include <system_error>
#include <thread>

#include "core/output_files.h"
#include "core/process.h"

#ifdef __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define INTAGLIO_IS_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define INTAGLIO_IS_SANITIZED
#endif

namespace intaglio::app {

std::atomic<bool> interrupted{false};

namespace {

#ifdef INTAGLIO_IS_SANITIZED
// Threads are joined slowly, and leaks are found after that.
constexpr std::chrono::milliseconds patience(60'000);
#else
constexpr std::chrono::milliseconds patience(300);
#endif
// Signals this close together are one: timeout(1), terminals and shells signal a process and then its group.
constexpr std::int64_t one_signal_ns = 100'000'000;

std::atomic<int> first_signal{0}, planned_code{-1};
std::atomic<std::int64_t> signalled_at{0};
std::atomic<bool> is_graceful{false}, is_quiet{false};
static_assert(std::atomic<std::int64_t>::is_always_lock_free);  // as a signal handler needs it
sem_t wake;

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

// In whichever thread the signal finds; hence atomics and async-signal-safe calls only.
void handle(int signal) {
  const int error = errno;
  int none = 0;
  if (first_signal.compare_exchange_strong(none, signal)) {
    signalled_at = now_ns();
    interrupted = true;
    sem_post(&wake);
  } else if (signal != SIGPIPE && now_ns() - signalled_at > one_signal_ns) {
    _exit(128 + signal);
  }
  while (signal == SIGPIPE) pause();  // the writer must not go on, to report an error
  errno = error;
}

std::string what_is_left(const AbandonedOutputs& outputs) {
  if (outputs.kept > 0) return "the next run with the same --record-to completes the recording";
  if (outputs.committed == 0) return "nothing was written";
  return fmt::format("{} {} written before", outputs.committed,
                     outputs.committed == 1 ? "file was" : "files were");
}

// Prints a line, over the progress bar of a terminal, unless standard error would block.
void print_line(const std::string& line) {
  pollfd out{STDERR_FILENO, POLLOUT, 0};
  if (poll(&out, 1, 0) != 1) return;
  const std::string text = (isatty(STDERR_FILENO) != 0 ? "\r\x1b[K" : "") + line;
  (void)!write(STDERR_FILENO, text.data(), text.size());
}

void end_when_woken() {
  while (sem_wait(&wake) != 0) {
  }
  if (first_signal == 0 || is_graceful) std::this_thread::sleep_for(patience);
  kill_all_processes();  // first, since they may create files at the temporaries' names
  const AbandonedOutputs outputs = abandon_outputs();
  const bool is_planned = planned_code >= 0, is_silent = first_signal == SIGHUP || first_signal == SIGPIPE;
  if (!is_quiet && !is_silent && (!is_planned || outputs.kept > 0))
    print_line(fmt::format("intaglio: {}{}\n", is_planned ? "" : "interrupted: ", what_is_left(outputs)));
  _exit(is_planned ? planned_code.load() : interrupted_code());
}

}  // namespace

void watch_for_stop() {
  sem_init(&wake, 0, 0);
  try {
    std::thread(end_when_woken).detach();
  } catch (const std::system_error&) {
    return;  // signals end the process as they do by default
  }
  struct sigaction action {
  }, before{};
  action.sa_handler = handle;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    // nohup(1) and services ignore the latter two. The former work even in the background of a script, where
    // shells ignore SIGINT.
    const bool may_be_ignored = signal == SIGHUP || signal == SIGPIPE;
    if (may_be_ignored && sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    sigaction(signal, &action, nullptr);
  }
}

int interrupted_code() {
  return 128 + first_signal;
}

void end_gracefully() {
  is_graceful = true;
}

void stop_quietly() {
  is_quiet = true;
}

void end_soon(int code) {
  planned_code = code;
  sem_post(&wake);
}

void wait_if_stopped() {
  while (interrupted && !is_graceful) pause();
}

}  // namespace intaglio::app
