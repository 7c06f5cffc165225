#include <doctest/doctest.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <string>
#include <utility>

#include "core/process.h"

using namespace intaglio;

namespace {

Result<void> shell(const std::string& command, const ProcessLimits& limits = {}) {
  return run_limited("/bin/sh", {"-c", command}, "/", limits);
}

// A pipe that is closed when the last process that holds its write end has ended.
struct Pipe {
  int from = -1, to = -1;
  Pipe() {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    from = ends[0];
    to = ends[1];
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close(from);
    close_end();
  }
  void close_end() {
    if (to >= 0) close(std::exchange(to, -1));
  }
  char read_one() const {
    char text = 0;
    return read(from, &text, 1) == 1 ? text : '\0';
  }
  // Whether all that hold the write end have ended within 10 s.
  bool is_closed() const {
    pollfd ready{from, POLLIN, 0};
    return ::poll(&ready, 1, 10'000) == 1 && read_one() == '\0';
  }
};

// Runs work in a forked process, which inherits `pipe`'s write end.
pid_t in_other_process(const Pipe& pipe, const std::function<void()>& work) {
  const pid_t id = fork();
  REQUIRE(id >= 0);
  if (id > 0) return id;
  close(pipe.from);
  work();
  _exit(0);
}

}  // namespace

TEST_CASE("success, exit codes, signals and time-outs of a child process are distinguished") {
  CHECK(shell("exit 0"));
  CHECK(shell("exit 3").error().message().find("code 3") != std::string::npos);
  CHECK(shell("kill -SEGV $$").error().message().find("crashed") != std::string::npos);
  ProcessLimits limits;
  limits.seconds = 0.1;
  CHECK(shell("sleep 20", limits).error().message().find("took more than 0.1 s") != std::string::npos);
  CHECK_FALSE(run_limited("/no/such/program", {}, "/", {}));
}

TEST_CASE("the error of a child process ends with the last line of its standard error") {
  CHECK(shell("echo on its way >&2; echo out of paper >&2; exit 3").error().what ==
        "ended with code 3: out of paper");
}

TEST_CASE("where the host ignores SIGCHLD the status of a child process is the same") {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  const auto well = shell("exit 0");
  const auto failed = shell("exit 3");
  const auto crashed = shell("kill -SEGV $$");
  ProcessLimits limits;
  limits.seconds = 0.1;
  const auto late = shell("sleep 20", limits);
  const auto absent = run_limited("/no/such/program", {}, "/", {});
  std::signal(SIGCHLD, before);
  CHECK(well);
  REQUIRE_FALSE(failed);
  CHECK(failed.error().message().find("code 3") != std::string::npos);
  REQUIRE_FALSE(crashed);
  CHECK(crashed.error().message().find("crashed") != std::string::npos);
  REQUIRE_FALSE(late);
  CHECK(late.error().message().find("took more than 0.1 s") != std::string::npos);
  CHECK_FALSE(absent);
}

TEST_CASE("a child process reads the given descriptor, and is killed with its object") {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  REQUIRE(write(ends[1], "3\n", 2) == 2);
  close(ends[1]);
  SpawnOptions options;
  options.input = ends[0];
  auto child = Process::start("/bin/sh", {"-c", "read code; exit $code"}, options);
  close(ends[0]);
  REQUIRE(child);
  CHECK(child->wait().error().what == "ended with code 3");
  CHECK(Process::start("/bin/sh", {"-c", "sleep 20"}));  // if it were not killed, the test would take 20 s
}

TEST_CASE("a child process and its children die with a parent that is killed") {
  for (const bool is_discarded : {false, true}) {
    INFO("SIGCHLD is ignored: " << is_discarded);
    Pipe pipe;
    const pid_t parent = in_other_process(pipe, [&] {
      if (is_discarded) std::signal(SIGCHLD, SIG_IGN);
      SpawnOptions options;
      options.input = pipe.to;  // as standard input, which can also be written to
      const auto child = Process::start("/bin/sh", {"-c", "echo . >&0; exec sleep 60"}, options);
      close(pipe.to);
      for (;;) pause();
    });
    pipe.close_end();
    CHECK(pipe.read_one() == '.');
    CHECK(pipe.read_one() == '\n');
    kill(parent, SIGKILL);
    CHECK(pipe.is_closed());
    waitpid(parent, nullptr, 0);
  }
}

TEST_CASE("a program that ends kills all its child processes") {
  Pipe pipe;
  const pid_t parent = in_other_process(pipe, [&] {
    SpawnOptions options;
    options.input = pipe.to;
    const auto one = Process::start("/bin/sh", {"-c", "sleep 60 & sleep 60"}, options);
    const auto two = Process::start("/bin/sh", {"-c", "trap '' TERM; sleep 60"}, options);
    kill_all_processes();
    close(pipe.to);
    for (;;) pause();
  });
  pipe.close_end();
  CHECK(pipe.is_closed());
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
}

TEST_CASE("a child process inherits neither blocked signals nor the group") {
  sigset_t blocked, before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  sigprocmask(SIG_BLOCK, &blocked, &before);
  auto child = Process::start("/bin/sh", {"-c", "kill -TERM $$; exit 3"});
  sigprocmask(SIG_SETMASK, &before, nullptr);
  REQUIRE(child);
  CHECK(child->wait().error().what == "crashed (Terminated)");
  CHECK(shell("[ $(ps -o pgid= -p $$) = $$ ]"));
}

TEST_CASE("a child process can be asked to end, and its memory is limited from its first instruction on") {
  SpawnOptions options;
  options.memory_mb = 100;
  auto child = Process::start("/bin/sh", {"-c", "[ $(ulimit -v) = 102400 ] || exit 3; sleep 60"}, options);
  REQUIRE(child);
  child->terminate();
  CHECK(child->wait().error().what == "crashed (Terminated)");
  CHECK(shell("[ $(ulimit -v) = 4096000 ]"));
}
