#include <doctest/doctest.h>
#include <unistd.h>

#include <csignal>

#include "core/process.h"

using namespace intaglio;

namespace {

Result<void> shell(const std::string& command, const ProcessLimits& limits = {}) {
  return run_limited("/bin/sh", {"-c", command}, "/", limits);
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
