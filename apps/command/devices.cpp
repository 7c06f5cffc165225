// intaglio devices list | monitor NAME@HOST | serve
//
// Exit codes beyond those of every verb (verb.h): 3 the host cannot be reached; 4 connection refused; 5 no
// answer in time; 6 not a VRPN server; 7 the link was lost; 8 the port to serve on is taken.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

#include "command/stop.h"
#include "command/verb.h"
#include "core/text.h"
#include "haptics/vrpn/client.h"
#include "haptics/vrpn/force.h"
#include "haptics/vrpn/payloads.h"
#include "haptics/vrpn/server.h"

namespace intaglio::app {

using namespace haptics::vrpn;

namespace {

using std::chrono::steady_clock;

int exit_code(LinkFault fault) {
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

// Prints the failure in one line; returns its exit code.
int report_link(const LinkError& failure) {
  report(failure.error);
  return exit_code(failure.fault);
}

struct ListArguments {
  int port = default_port;
  bool json = false;
};

struct ServeArguments {
  std::string bind = "127.0.0.1";
  int port = default_port;
  double seconds = 0, rate = 1000, hold = 0.040;
};

// Names of the devices of a VRPN server on this machine.
std::vector<std::string> local_device_names(int port) {
  using namespace std::chrono_literals;
  const auto client = Client::connect({"Intaglio", "127.0.0.1", port, true}, {300ms, &interrupted});
  std::vector<std::string> names;
  if (!client) return names;
  // Names follow the cookie.
  const auto end = std::chrono::steady_clock::now() + 200ms;
  while (std::chrono::steady_clock::now() < end && (*client)->fault() == LinkFault::none)
    (*client)->step(20ms, [](const Received&) { return true; });
  for (const std::string& name : (*client)->connection().peer_names().senders())
    if (name != "VRPN Control") names.push_back(name);
  return names;
}

int run_list(const ListArguments& options) {
  const std::vector<std::string> names = local_device_names(options.port);
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
      "null         accepts every force, applies none\n"
      "replay       positions of a recorded session\n"
      "vrpn         NAME@HOST[:PORT]: tracker, buttons and force device behind a VRPN server\n");
  if (names.empty()) fmt::print("\nNo VRPN server on this machine at port {}.\n", options.port);
  for (const std::string& name : names)
    fmt::print("\nHere: {0}@localhost:{1}\n  intaglio devices monitor {0}@localhost:{1}\n", name,
               options.port);
  return 0;
}

int run_serve(const ServeArguments& options, const Common& common) {
  end_gracefully();
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
    LinkError failure = server.error();
    if (failure.fault == LinkFault::port_taken) failure.error.fix = "choose another with --port";
    return report_link(failure);
  }
  const auto at = parse_ipv4(options.bind, options.port);
  if (!at || !at->loopback())
    print_error(fmt::format(
        "intaglio: warning: VRPN has no authentication: anyone who can reach {} can move the device\n",
        options.bind));
  say(fmt::format("serving Phantom0 on {}:{}; stop with Ctrl-C", options.bind, (*server)->port()));
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds);
  std::atomic<bool> over{false};
  std::thread watch([&] {
    while (!interrupted && !over && (options.seconds <= 0 || std::chrono::steady_clock::now() < end))
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    over = true;
  });
  (*server)->run(over);
  watch.join();
  say(fmt::format("stopped; {} force messages were received", (*server)->force_messages()));
  return 0;
}

struct MonitorArguments {
  std::string address;
  bool tcp = false, json = false;
  double seconds = 0;  // 0: until interrupted
};

constexpr double warn_after = 3, give_up_after = 10;  // s without an answer to a ping
constexpr double text_period = 0.1;                   // s between lines of one kind

std::string triple(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

// Prints a device's messages, for people or for programs.
class Printer {
 public:
  explicit Printer(bool json) : json_(json) {}

  bool print(const Received& received);
  void line(std::string_view event, const std::string& members) const {
    fmt::print("{{\"event\": \"{}\", \"t\": {:.6f}{}{}}}\n", event, elapsed(), members.empty() ? "" : ", ",
               members);
  }
  double elapsed() const { return std::chrono::duration<double>(steady_clock::now() - start_).count(); }
  bool json() const { return json_; }

  int poses = 0, buttons = 0, forces = 0;

 private:
  bool pose(const Received& received, const std::string& stamp);
  bool button(const Received& received, const std::string& stamp);
  bool states(const Received& received, const std::string& stamp);
  bool force(const Received& received, const std::string& stamp);
  bool force_error(const Received& received, const std::string& stamp);
  bool text(const Received& received, const std::string& stamp);
  // Rate limit for frequent messages.
  bool is_due(double& last) const {
    if (elapsed() - last < text_period) return false;
    last = elapsed();
    return true;
  }

  bool json_;
  steady_clock::time_point start_ = steady_clock::now();
  double last_pose_ = -1, last_force_ = -1;
};

bool Printer::print(const Received& received) {
  const std::string stamp = fmt::format("\"time\": {}.{:06d}", received.time.seconds,
                                        std::clamp(received.time.microseconds, 0, 999999));
  switch (received.type) {
    case Type::pos_quat:
      return pose(received, stamp);
    case Type::button_change:
      return button(received, stamp);
    case Type::button_states:
      return states(received, stamp);
    case Type::force:
      return force(received, stamp);
    case Type::force_error:
      return force_error(received, stamp);
    case Type::text:
      return text(received, stamp);
    default:
      return true;
  }
}

bool Printer::pose(const Received& received, const std::string& stamp) {
  const auto pose = decode_pos_quat(received.payload);
  if (!pose) return false;
  ++poses;
  const auto& q = pose->quat;
  if (json_) {
    line("pose", fmt::format("{}, \"sensor\": {}, \"position\": {}, \"orientation\": [{}, {}, {}, {}]", stamp,
                             pose->sensor, triple(pose->position), q[0], q[1], q[2], q[3]));
  } else if (is_due(last_pose_)) {
    const Vec3 mm = 1000 * pose->position;
    fmt::print("{:9.3f} s  sensor {}  {:9.3f} {:9.3f} {:9.3f} mm  x y z w {:.4f} {:.4f} {:.4f} {:.4f}\n",
               elapsed(), pose->sensor, mm.x(), mm.y(), mm.z(), q[0], q[1], q[2], q[3]);
  }
  return true;
}

bool Printer::button(const Received& received, const std::string& stamp) {
  const auto change = decode_button_change(received.payload);
  if (!change) return false;
  ++buttons;
  if (json_) {
    line("button",
         fmt::format("{}, \"button\": {}, \"pressed\": {}", stamp, change->button, change->state != 0));
  } else {
    fmt::print("{:9.3f} s  button {} {}\n", elapsed(), change->button,
               change->state != 0 ? "pressed" : "released");
  }
  return true;
}

bool Printer::states(const Received& received, const std::string& stamp) {
  const auto states = decode_button_states(received.payload);
  if (!states) return false;
  std::string list;
  for (const std::int32_t state : *states)
    list += (list.empty() ? "" : ", ") + std::string(state ? "true" : "false");
  if (json_) {
    line("buttons", fmt::format("{}, \"pressed\": [{}]", stamp, list));
  } else {
    fmt::print("{:9.3f} s  buttons pressed: {}\n", elapsed(), list);
  }
  return true;
}

bool Printer::force(const Received& received, const std::string& stamp) {
  const auto force = decode_force(received.payload);
  if (!force) return false;
  ++forces;
  const Vec3& f = force->newtons;
  if (json_) {
    line("force", fmt::format("{}, \"newtons\": {}", stamp, triple(f)));
  } else if (!f.isZero(0) && is_due(last_force_)) {
    fmt::print("{:9.3f} s  force {:8.4f} {:8.4f} {:8.4f} N\n", elapsed(), f.x(), f.y(), f.z());
  }
  return true;
}

bool Printer::force_error(const Received& received, const std::string& stamp) {
  const auto error = decode_force_error(received.payload);
  if (!error) return false;
  if (json_) {
    line("force_error",
         fmt::format("{}, \"code\": {}, \"meaning\": \"{}\"", stamp, int(*error), describe(*error)));
  } else {
    fmt::print("{:9.3f} s  force device: {}\n", elapsed(), describe(*error));
  }
  return true;
}

bool Printer::text(const Received& received, const std::string& stamp) {
  static constexpr const char* severities[] = {"normal", "warning", "error"};
  const auto text = decode_text(received.payload);
  if (!text) return false;
  if (json_) {
    line("text", fmt::format("{}, \"severity\": \"{}\", \"level\": {}, \"text\": {}", stamp,
                             severities[text->severity], text->level, json_quoted(text->text)));
  } else {
    fmt::print("{:9.3f} s  {}: {}\n", elapsed(), severities[text->severity], text->text);
  }
  return true;
}

void print_link(const Printer& printer, const Address& address, const Connection& connection) {
  const Cookie& cookie = connection.peer_cookie();
  const char* transport = address.tcp_only ? "tcp" : "udp";
  if (cookie.match == CookieMatch::other_minor_version)
    print_error(fmt::format("intaglio: warning: {} uses VRPN {}; this client uses 07.38\n", address.text(),
                            cookie.version));
  if (printer.json()) {
    printer.line("link", fmt::format("\"device\": {}, \"transport\": \"{}\", \"version\": {}",
                                     json_quoted(address.text()), transport, json_quoted(cookie.version)));
  } else {
    fmt::print("{}: connected over {}, VRPN {}\n", address.text(), transport, cookie.version);
  }
}

void print_summary(const Printer& printer, std::string_view reason) {
  const double rate = printer.poses / std::max(printer.elapsed(), 1e-9);
  if (printer.json()) {
    printer.line(
        "end",
        fmt::format("\"reason\": \"{}\", \"poses\": {}, \"buttons\": {}, \"forces\": {}, \"rate\": {:.1f}",
                    reason, printer.poses, printer.buttons, printer.forces, rate));
  } else {
    fmt::print("{}: {} poses ({:.0f} Hz), {} button changes, {} forces\n", reason, printer.poses, rate,
               printer.buttons, printer.forces);
  }
}

// Warns once of a server that does not answer; then timed_out.
LinkFault check_answers(const Client& client, const Address& address, bool& warned) {
  const double unanswered = std::chrono::duration<double>(client.ping_age()).count();
  if (unanswered > warn_after && !warned) {
    warned = true;
    print_error(fmt::format("intaglio: warning: {}: no answer for {} s; check the device name \"{}\"\n",
                            address.text(), warn_after, address.name));
  }
  return unanswered > give_up_after ? LinkFault::timed_out : client.fault();
}

int run_monitor(const MonitorArguments& options, const Common& common) {
  auto address = parse_address(options.address);
  if (!address) {
    report(address.error());
    return 2;
  }
  address->tcp_only = address->tcp_only || options.tcp;
  end_gracefully();
  const auto client = Client::connect(*address, {std::chrono::seconds(3), &interrupted});
  if (!client) return client.error().fault == LinkFault::stopped ? 0 : report_link(client.error());
  Printer printer(options.json);
  print_link(printer, *address, (*client)->connection());
  LinkFault fault = LinkFault::none;
  bool warned = false;
  while (fault == LinkFault::none && !interrupted &&
         (options.seconds <= 0 || printer.elapsed() < options.seconds)) {
    (*client)->step(std::chrono::milliseconds(20),
                    [&](const Received& received) { return printer.print(received); });
    std::fflush(stdout);
    fault = check_answers(**client, *address, warned);
  }
  if (options.json || !common.quiet)
    print_summary(printer, fault == LinkFault::none ? "finished" : describe(fault));
  return fault == LinkFault::none
             ? 0
             : report_link(LinkError{fault, {address->text(), std::string(describe(fault)), ""}});
}

constexpr const char* exit_codes =
    "Exit codes: 0 done; 2 wrong command line; 3 host cannot be reached; 4 connection refused;\n"
    "5 no answer in time; 6 not a VRPN server; 7 link lost; 8 port taken.\n";

void add_list(CLI::App& devices, Common& common) {
  CLI::App* verb = devices.add_subcommand("list", "List device kinds and the local VRPN server's devices");
  auto options = std::make_shared<ListArguments>();
  verb->add_option("--port", options->port, "Port of the VRPN server on this machine")
      ->check(CLI::Range(1, 65535))
      ->capture_default_str();
  verb->add_flag("--json", options->json, "Print one JSON object: kinds, port, here");
  verb->callback([options, &common] { common.exit_code = run_list(*options); });
}

void add_monitor(CLI::App& devices, Common& common) {
  CLI::App* verb =
      devices.add_subcommand("monitor", "Print poses, buttons and forces of a VRPN device; sends nothing");
  auto options = std::make_shared<MonitorArguments>();
  verb->add_option("NAME@HOST[:PORT]", options->address,
                   "The device, for example Phantom0@localhost (port 3883)")
      ->required();
  verb->add_flag(
      "--tcp", options->tcp,
      "Use TCP only; by default a UDP request asks the server to connect back, and low-latency messages come by UDP");
  verb->add_option("--seconds", options->seconds, "Stop after this many seconds; 0: run until Ctrl-C")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  verb->add_flag(
      "--json", options->json,
      "Print every message as a line of JSON (docs/devices.md lists the keys); default: ten lines a second");
  verb->footer(std::string(exit_codes) +
               "Examples:\n  intaglio devices monitor Phantom0@localhost --seconds 5\n"
               "  intaglio devices monitor Tracker0@lab-pc:4500 --tcp --json > session.jsonl");
  verb->callback([options, &common] { common.exit_code = run_monitor(*options, common); });
}

void add_serve(CLI::App& devices, Common& common) {
  CLI::App* verb = devices.add_subcommand(
      "serve", "Serve a simulated PHANToM as Phantom0, for VRPN programs without a device");
  auto options = std::make_shared<ServeArguments>();
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
                   "Address to serve on; 0.0.0.0 lets other machines in (VRPN has no authentication)")
      ->capture_default_str();
  verb->add_option("--seconds", options->seconds, "Stop after this many seconds; 0: run until Ctrl-C")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  verb->add_option("--rate", options->rate, "Reports a second, until a client asks for another rate")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  verb->add_option(
          "--hold", options->hold,
          "Seconds that a force, plane or field lasts after its client's last message; more than the safe default "
          "only for programs that send a plane once")
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
      app.add_subcommand("devices", "Haptic devices: list, monitor, or serve a simulated one");
  devices->require_subcommand(1);
  devices->footer(
      "Start with:\n  intaglio devices serve &\n  intaglio devices monitor Phantom0@localhost --seconds 2\n"
      "docs/devices.md: safety, transports, what is on the wire.");
  add_list(*devices, common);
  add_monitor(*devices, common);
  add_serve(*devices, common);
}

}  // namespace intaglio::app
