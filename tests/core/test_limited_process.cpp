#include <doctest/doctest.h>

#include <csignal>

#include "core/process.h"

using namespace intaglio;

namespace {

Result<void> shell(const std::string& command, const ProcessLimits& limits = {}) {
  return run_limited("/bin/sh", {"-c", command}, "/", limits);
}

}  // namespace

TEST_CASE("a child process ends well, with a code, by a signal, or too late, and each is told apart") {
  CHECK(shell("exit 0"));
  CHECK(shell("exit 3").error().message().find("code 3") != std::string::npos);
  CHECK(shell("kill -SEGV $$").error().message().find("crashed") != std::string::npos);
  ProcessLimits limits;
  limits.seconds = 0.1;
  CHECK(shell("sleep 20", limits).error().message().find("took more than 0.1 s") != std::string::npos);
  CHECK_FALSE(run_limited("/no/such/program", {}, "/", {}));
}

TEST_CASE("where the host ignores SIGCHLD a crash is not taken for success") {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  const auto crashed = shell("exit 3");
  std::signal(SIGCHLD, before);
  REQUIRE_FALSE(crashed);
  CHECK(crashed.error().message().find("SIGCHLD") != std::string::npos);
}
