// intaglio devices monitor NAME@HOST[:PORT]
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "app/devices.h"
#include "intaglio/core/json_text.h"
#include "intaglio/haptics/devices/vrpn/button.h"
#include "intaglio/haptics/devices/vrpn/client.h"
#include "intaglio/haptics/devices/vrpn/force_messages.h"
#include "intaglio/haptics/devices/vrpn/text.h"
#include "intaglio/haptics/devices/vrpn/tracker.h"

namespace intaglio::app {

using namespace haptics::vrpn;
using std::chrono::steady_clock;

namespace {

constexpr double warn_after = 3, give_up_after = 10;  // s without an answer to a ping
constexpr double text_period = 0.1;                   // s between two lines of one kind for people

std::string triple(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

// Prints what a device sends, for people or for programs.
class Printer {
 public:
  explicit Printer(bool json) : json_(json) {}

  bool take(const Received& received);
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
  // Whether a line of a kind that comes often is due.
  bool due(double& last) const {
    if (elapsed() - last < text_period) return false;
    last = elapsed();
    return true;
  }

  bool json_;
  steady_clock::time_point start_ = steady_clock::now();
  double last_pose_ = -1, last_force_ = -1;
};

bool Printer::take(const Received& received) {
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
  } else if (due(last_pose_)) {
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
  } else if (!f.isZero(0) && due(last_force_)) {
    fmt::print("{:9.3f} s  force {:8.4f} {:8.4f} {:8.4f} N\n", elapsed(), f.x(), f.y(), f.z());
  }
  return true;
}

bool Printer::force_error(const Received& received, const std::string& stamp) {
  const auto error = decode_force_error(received.payload);
  if (!error) return false;
  if (json_) {
    line("force_error", fmt::format("{}, \"code\": {}, \"meaning\": \"{}\"", stamp, static_cast<int>(*error),
                                    meaning(*error)));
  } else {
    fmt::print("{:9.3f} s  force device: {}\n", elapsed(), meaning(*error));
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
    fmt::print(stderr, "intaglio: warning: {} speaks VRPN {}, we 07.38\n", address.text(), cookie.version);
  if (printer.json()) {
    printer.line("link", fmt::format("\"device\": {}, \"transport\": \"{}\", \"version\": {}",
                                     json_quoted(address.text()), transport, json_quoted(cookie.version)));
  } else {
    fmt::print("{}: linked by {}, VRPN {}\n", address.text(), transport, cookie.version);
  }
}

void print_end(const Printer& printer, std::string_view reason) {
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

// Warns once, and says when to give up, of a server that does not answer to that name.
LinkFault patience(const Client& client, const Address& address, bool& warned) {
  const double unanswered = std::chrono::duration<double>(client.unanswered()).count();
  if (unanswered > warn_after && !warned) {
    warned = true;
    fmt::print(stderr, "intaglio: warning: {}: no answer for {} s; does the server know \"{}\"?\n",
               address.text(), warn_after, address.name);
  }
  return unanswered > give_up_after ? LinkFault::timed_out : client.fault();
}

}  // namespace

int run_monitor(const MonitorOptions& options, const Common& common) {
  auto address = parse_address(options.address);
  if (!address) {
    report(address.error());
    return 2;
  }
  address->tcp_only = address->tcp_only || options.tcp;
  catch_interrupts();
  const auto client = Client::connect(*address, {std::chrono::seconds(3), &devices_interrupted});
  if (!client) return client.error().fault == LinkFault::stopped ? 0 : report(client.error());
  Printer printer(options.json);
  print_link(printer, *address, (*client)->connection());
  LinkFault fault = LinkFault::none;
  bool warned = false;
  while (fault == LinkFault::none && !devices_interrupted &&
         (options.seconds <= 0 || printer.elapsed() < options.seconds)) {
    (*client)->step(std::chrono::milliseconds(20),
                    [&](const Received& received) { return printer.take(received); });
    std::fflush(stdout);
    fault = patience(**client, *address, warned);
  }
  if (options.json || !common.quiet)
    print_end(printer, fault == LinkFault::none ? "finished" : meaning(fault));
  return fault == LinkFault::none
             ? 0
             : report(LinkFailure{fault, {address->text(), std::string(meaning(fault)), ""}});
}

}  // namespace intaglio::app
