// A peer in another process is killed or freezes: the force is zero within 50 ms. The machine may be busy
// with other work, so the best of a few tries counts.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "haptics/vrpn/vrpn_device.h"
#include "tests/haptics/vrpn_peers.h"

using namespace intaglio;
using namespace intaglio::haptics;
using namespace intaglio::haptics::vrpn;

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

double ms_since(SteadyTime start) {
  return std::chrono::duration<double, std::milli>(steady_clock::now() - start).count();
}

// Another process that runs `work` until it is killed. Forked before this process has threads.
template <class Work>
struct Process {
  explicit Process(Work work) {
    id = ::fork();
    if (id != 0) return;
    work();
    ::_exit(0);
  }
  ~Process() {
    ::kill(id, SIGKILL);
    ::waitpid(id, nullptr, 0);
  }
  pid_t id = -1;
};

ServerOptions on_port(int port) {
  ServerOptions options;
  options.port = port;
  options.phantom.path = {{0, {0, -0.001, 0}}};
  return options;
}

// Milliseconds from a signal to the remote client until our server displays no force.
double server_lets_go(int signal, bool tcp_only) {
  auto server = std::move(*Server::open(on_port(0)));
  const int port = server->port();
  Process client([=] {
    auto link = Client::connect({"Phantom0", "127.0.0.1", port, tcp_only});
    Bytes payload;
    encode(payload, ForceReport{{0, 2, 0}});
    while (link && (*link)->fault() == LinkFault::none) {
      (*link)->send(Type::force, payload, Channel::low_latency);
      (*link)->step(milliseconds(1), [](const Received&) { return true; });
    }
  });
  const auto step = [&] {
    server->step(steady_clock::now());
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    return server->phantom().force.norm();
  };
  REQUIRE(eventually([&] { return step() > 1; }));
  const SteadyTime start = steady_clock::now();
  ::kill(client.id, signal);
  REQUIRE(eventually([&] { return step() == 0; }));
  return ms_since(start);
}

// Milliseconds from a signal to the remote server until our guard passes no force.
double client_lets_go(int signal, bool tcp_only) {
  const int port = local_address(*listen_tcp({loopback_host, 0})).port;
  Process far([=] {
    auto server = Server::open(on_port(port));
    const std::atomic<bool> forever{false};
    if (server) (*server)->run(forever);
  });
  VrpnDevice device({"Phantom0", "127.0.0.1", port, tcp_only});
  REQUIRE(device.wait_for_link(test_patience));
  Guard guard{{}};
  const auto tick = [&] {
    // A spring towards a point above the tip; NaN when the link is lost.
    const GuardedForce force = guard.pass(800 * (Vec3(0, 0.005, 0) - device.read()), 0.001);
    device.write(force);
    std::this_thread::sleep_for(milliseconds(1));
    return force.newtons().norm();
  };
  REQUIRE(eventually([&] {
    if ((guard.status() & guard_status::fault) != 0) guard.rearm();
    return tick() > 0.5;
  }));
  const SteadyTime start = steady_clock::now();
  ::kill(far.id, signal);
  REQUIRE(eventually([&] { return tick() == 0; }));
  const double taken = ms_since(start);
  CHECK((guard.status() & guard_status::fault) != 0);
  return taken;
}

template <class Measure>
double best_of(int tries, Measure measure) {
  double best = 1e9;
  for (int k = 0; k < tries && best > 50; ++k) best = std::min(best, measure());
  return best;
}

}  // namespace

TEST_CASE("a client of a served phantom that dies or freezes leaves no force after 50 ms") {
  for (const bool tcp_only : {false, true}) {
    for (const int signal : {SIGKILL, SIGSTOP}) {
      const double ms = best_of(5, [&] { return server_lets_go(signal, tcp_only); });
      MESSAGE((signal == SIGKILL ? "killed" : "frozen") << (tcp_only ? ", TCP: " : ", UDP: ") << ms << " ms");
      CHECK(ms <= 50);
    }
  }
}

TEST_CASE("a device whose server dies or freezes gets no force after 50 ms, and the fault latches") {
  for (const bool tcp_only : {false, true}) {
    for (const int signal : {SIGKILL, SIGSTOP}) {
      const double ms = best_of(5, [&] { return client_lets_go(signal, tcp_only); });
      MESSAGE((signal == SIGKILL ? "killed" : "frozen") << (tcp_only ? ", TCP: " : ", UDP: ") << ms << " ms");
      CHECK(ms <= 50);
    }
  }
}

TEST_CASE("the phantom's force begins to fall 40 ms after the last request, and is zero at 50 ms") {
  PhantomOptions options;
  options.path = {{0, {0, 0, 0}}};
  ServedPhantom phantom(options);
  SteadyTime now{};
  for (int k = 0; k < 1000; ++k) {
    now += milliseconds(1);
    phantom.request(ForceReport{{0, 7, 0}}, now);
    phantom.tick(0.001, now);
  }
  REQUIRE(phantom.state().force.norm() > 1);
  for (int k = 0; k < 40; ++k) phantom.tick(0.001, now += milliseconds(1));
  CHECK(phantom.state().force.norm() > 1);
  for (int k = 0; k < 10; ++k) phantom.tick(0.001, now += milliseconds(1));
  CHECK(phantom.state().force.norm() == 0);
  CHECK_FALSE(phantom.is_held());
  // It ramps in anew.
  phantom.request(ForceReport{{0, 7, 0}}, now);
  phantom.tick(0.001, now += milliseconds(1));
  CHECK(phantom.state().force.norm() < 0.1);
}
