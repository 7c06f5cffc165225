// intaglio devices list | monitor NAME@HOST | serve
#include "app/devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <thread>

#include "intaglio/core/json_text.h"
#include "intaglio/haptics/devices/vrpn/client.h"
#include "intaglio/haptics/devices/vrpn/server.h"

namespace intaglio::app {

using namespace haptics::vrpn;

std::atomic<bool> devices_interrupted{false};

void catch_interrupts() {
  std::signal(SIGINT, [](int) { devices_interrupted = true; });
  std::signal(SIGTERM, [](int) { devices_interrupted = true; });
}

static int exit_code(LinkFault fault) {
  switch (fault) {
    case LinkFault::unreachable:
      return 3;
    case LinkFault::refused:
      return 4;
    case LinkFault::timed_out:
      return 5;
    case LinkFault::not_vrpn:
      return 6;
    case LinkFault::port_taken:
      return 8;
    default:
      return 7;
  }
}

int report(const LinkFailure& failure) {
  report(failure.error);
  return exit_code(failure.fault);
}

namespace {

struct ListOptions {
  int port = default_port;
  bool json = false;
};

struct ServeOptions {
  std::string bind = "127.0.0.1";
  int port = default_port;
  double seconds = 0, rate = 1000, hold = 0.040;
};

// What a VRPN server on this machine shows; empty when there is none.
std::vector<std::string> served_here(int port) {
  using namespace std::chrono_literals;
  const auto client = Client::connect({"Intaglio", "127.0.0.1", port, true}, {300ms, &devices_interrupted});
  std::vector<std::string> names;
  if (!client) return names;
  // Names come right after the cookie.
  const auto end = std::chrono::steady_clock::now() + 200ms;
  while (std::chrono::steady_clock::now() < end && (*client)->fault() == LinkFault::none)
    (*client)->step(20ms, [](const Received&) { return true; });
  for (const std::string& name : (*client)->connection().peer_names().senders())
    if (name != "VRPN Control") names.push_back(name);
  return names;
}

int run_list(const ListOptions& options) {
  const std::vector<std::string> names = served_here(options.port);
  if (options.json) {
    std::string list;
    for (const std::string& name : names)
      list += (list.empty() ? "" : ", ") + json_quoted(fmt::format("{}@localhost:{}", name, options.port));
    fmt::print(
        "{{\"kinds\": [\"simulated\", \"null\", \"replay\", \"vrpn\"], \"port\": {}, \"here\": [{}]}}\n",
        options.port, list);
    return 0;
  }
  fmt::print(
      "simulated    a PHANToM Desktop in a simulated hand; what scenes and tests use\n"
      "null         takes every force and feels none\n"
      "replay       positions of a recorded session\n"
      "vrpn         NAME@HOST[:PORT]: tracker, buttons and force device behind a VRPN server\n");
  if (names.empty()) fmt::print("\nNo VRPN server on this machine at port {}.\n", options.port);
  for (const std::string& name : names)
    fmt::print("\nHere: {0}@localhost:{1}\n  intaglio devices monitor {0}@localhost:{1}\n", name,
               options.port);
  return 0;
}

int run_serve(const ServeOptions& options, const Common& common) {
  catch_interrupts();
  const auto say = [&](const std::string& line) {
    if (common.quiet) return;
    fmt::print("{}\n", line);
    std::fflush(stdout);  // scripts wait for these lines
  };
  ServerOptions server_options;
  server_options.bind = options.bind;
  server_options.port = options.port;
  server_options.report_rate = options.rate;
  server_options.phantom.silence = options.hold;
  server_options.log = say;
  const auto server = Server::open(server_options);
  if (!server) {
    LinkFailure failure = server.error();
    if (failure.fault == LinkFault::port_taken) failure.error.fix = "choose another with --port";
    return report(failure);
  }
  const auto at = parse_ipv4(options.bind, options.port);
  if (!at || !at->loopback())
    fmt::print(stderr, "intaglio: warning: VRPN knows no passwords; whoever reaches {} can move the hand\n",
               options.bind);
  say(fmt::format("serving Phantom0 on {}:{}; stop with Ctrl-C", options.bind, (*server)->port()));
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds);
  std::atomic<bool> over{false};
  std::thread watch([&] {
    while (!devices_interrupted && !over && (options.seconds <= 0 || std::chrono::steady_clock::now() < end))
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    over = true;
  });
  (*server)->run(over);
  watch.join();
  say(fmt::format("stopped; {} force messages were received", (*server)->force_messages()));
  return 0;
}

constexpr const char* exit_codes =
    "Exit codes: 0 done; 2 wrong command line; 3 host cannot be reached; 4 refused: nobody at that port;\n"
    "5 no answer in time; 6 not a VRPN server; 7 link lost; 8 port taken.\n";

void add_list(CLI::App& devices, Common& common) {
  CLI::App* verb =
      devices.add_subcommand("list", "What can be used, and what a VRPN server on this machine shows");
  auto options = std::make_shared<ListOptions>();
  verb->add_option("--port", options->port, "Port of the VRPN server on this machine")
      ->check(CLI::Range(1, 65535))
      ->capture_default_str();
  verb->add_flag("--json", options->json, "One JSON object: kinds, port, here");
  verb->callback([options, &common] { common.exit_code = run_list(*options); });
}

void add_monitor(CLI::App& devices, Common& common) {
  CLI::App* verb =
      devices.add_subcommand("monitor", "Prints poses, buttons and forces of a VRPN device; touches nothing");
  auto options = std::make_shared<MonitorOptions>();
  verb->add_option("NAME@HOST[:PORT]", options->address,
                   "The device, for example Phantom0@localhost (port 3883)")
      ->required();
  verb->add_flag(
      "--tcp", options->tcp,
      "Dial the server by TCP and never use UDP; without, the server is asked by UDP to call back, and "
      "low-latency messages come by UDP");
  verb->add_option("--seconds", options->seconds, "Stop after so long; 0: until Ctrl-C")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  verb->add_flag(
      "--json", options->json,
      "Every message as one line of JSON (docs/devices.md lists the keys); without, ten lines a second");
  verb->footer(std::string(exit_codes) +
               "Examples:\n  intaglio devices monitor Phantom0@localhost --seconds 5\n"
               "  intaglio devices monitor Tracker0@lab-pc:4500 --tcp --json > session.jsonl");
  verb->callback([options, &common] { common.exit_code = run_monitor(*options, common); });
}

void add_serve(CLI::App& devices, Common& common) {
  CLI::App* verb = devices.add_subcommand(
      "serve", "Shows a simulated PHANToM as Phantom0, for VRPN programs without a device");
  auto options = std::make_shared<ServeOptions>();
  verb->add_option("--port", options->port, "TCP and UDP port; 0: any free one, which is printed")
      ->check(CLI::Validator(
          [](std::string& text) {
            const long port = std::strtol(text.c_str(), nullptr, 10);
            return text == "0" || (port >= 1024 && port <= 65535) ? ""
                                                                  : "the port must be 1024 to 65535, or 0";
          },
          "0, 1024..65535"))
      ->capture_default_str();
  verb->add_option("--bind", options->bind,
                   "Address to serve on; 0.0.0.0 lets other machines in, and VRPN knows no passwords")
      ->capture_default_str();
  verb->add_option("--seconds", options->seconds, "Stop after so long; 0: until Ctrl-C")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  verb->add_option("--rate", options->rate, "Reports a second, until a client asks for another rate")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  verb->add_option(
          "--hold", options->hold,
          "Seconds that a force, plane or field lasts after its client's last word. For programs that send "
          "a plane once; the default is the safe one")
      ->check(CLI::Range(0.005, 3600.0))
      ->capture_default_str();
  verb->footer(
      std::string(exit_codes) +
      "Example:\n  intaglio devices serve --port 4500 &\n  intaglio devices monitor Phantom0@localhost:4500");
  verb->callback([options, &common] { common.exit_code = run_serve(*options, common); });
}

}  // namespace

void add_devices(CLI::App& app, Common& common) {
  CLI::App* devices =
      app.add_subcommand("devices", "Haptic devices: list them, watch one, or serve a simulated one");
  devices->require_subcommand(1);
  devices->footer(
      "Start with:\n  intaglio devices serve &\n  intaglio devices monitor Phantom0@localhost --seconds 2\n"
      "docs/devices.md: safety, transports, what is on the wire.");
  add_list(*devices, common);
  add_monitor(*devices, common);
  add_serve(*devices, common);
}

}  // namespace intaglio::app
