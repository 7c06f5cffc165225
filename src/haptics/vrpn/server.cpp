#include "haptics/vrpn/server.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>
#include <fmt/format.h>

#include "core/portable_math.h"
#include "haptics/vrpn/client.h"
#include "haptics/vrpn/message.h"
#include "haptics/vrpn/payloads.h"

namespace intaglio::haptics::vrpn {

static constexpr double lap = 4;               // s
static constexpr double lasting = 12 * 3600;   // s
static constexpr double velocity_cutoff = 60;  // Hz

// A circle of 3 cm, from 2 cm above the middle of the workspace to 1 cm below.
static std::vector<Waypoint> laps() {
  std::vector<Waypoint> path;
  for (int k = 0; k * lap / 8 <= lasting; ++k) {
    const double angle = k * std::numbers::pi / 4;
    path.push_back({k * lap / 8,
                    {0.03 * elementary::cos(angle), 0.005 + 0.015 * elementary::cos(angle),
                     0.03 * elementary::sin(angle)}});
  }
  return path;
}

ServedPhantom::ServedPhantom(const PhantomOptions& options)
    : options_(options),
      device_(options.model, options.hand, options.path.empty() ? laps() : options.path),
      guard_(options.limits),
      asked_(options.units) {
  state_.position = device_.read();
}

void ServedPhantom::tick(double dt, Time now) {
  if (asked_.any() && std::chrono::duration<double>(now - asked_at_).count() > options_.silence) release();
  const Vec3 position = device_.read();
  const double keep = elementary::exp(-2 * std::numbers::pi * velocity_cutoff * dt);
  state_.velocity = keep * state_.velocity + (1 - keep) * (position - state_.position) / dt;
  state_.position = position;
  state_.contact = asked_.contact(position);
  const Vec3 wanted = asked_.newtons(position, state_.velocity);
  state_.too_much = wanted.norm() > options_.limits.peak_force;
  const GuardedForce guarded = guard_.pass(wanted, dt);
  state_.force = guarded.newtons();
  device_.write(guarded);
  device_.advance(dt);
  // The hand holds the first button for the third quarter of each lap.
  state_.buttons[0] =
      std::fmod(device_.time(), lap) >= lap / 2 && std::fmod(device_.time(), lap) < 0.75 * lap;
}

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

static constexpr std::chrono::milliseconds tick_period{1};
static constexpr int most_ticks_a_step =
    20;  // behind by more, the phantom loses time rather than the deadline
static constexpr std::chrono::seconds dial_patience{3};
static constexpr double fastest_reports = 1000, slowest_reports = 1;  // Hz

static nanoseconds period_of(double rate) {
  return nanoseconds(static_cast<std::int64_t>(1e9 / std::clamp(rate, slowest_reports, fastest_reports)));
}

// TCP and UDP on one port; when any will do, one that is free for both.
Linked<std::unique_ptr<Server>> Server::open(const ServerOptions& options) {
  const Linked<Ipv4> at = resolve(options.bind, options.port);
  if (!at) return tl::unexpected(at.error());
  for (int attempt = 0;; ++attempt) {
    Linked<Socket> tcp = listen_tcp(*at);
    if (!tcp) return tl::unexpected(tcp.error());
    Linked<Socket> udp = bind_udp({at->host, local_address(*tcp).port});
    if (udp)
      return std::unique_ptr<Server>(
          new Server(options, std::move(*tcp), std::move(*udp), steady_clock::now()));
    if (options.port != 0 || attempt == 20) return tl::unexpected(udp.error());
  }
}

Server::Server(const ServerOptions& options, Socket tcp, Socket udp, SteadyTime now)
    : options_(options),
      tcp_(std::move(tcp)),
      udp_(std::move(udp)),
      port_(local_address(tcp_).port),
      phantom_(options.phantom),
      next_tick_(now) {}

void Server::run(const std::atomic<bool>& stopped) {
  while (!stopped) {
    step(steady_clock::now());
    std::this_thread::sleep_until(next_tick_);
  }
}

void Server::step(SteadyTime now) {
  take_calls(now);
  take_requests(now);
  finish_dials(now);
  for (int k = 0; k < most_ticks_a_step && next_tick_ <= now; ++k) tick(next_tick_);
  if (next_tick_ <= now) next_tick_ = now + tick_period;
  for (Peer& peer : peers_) talk(peer, now);
  bury();
}

void Server::take_calls(SteadyTime now) {
  while (auto call = accept_tcp(tcp_)) admit(std::move(call->socket), call->peer, false, now);
}

void Server::admit(Socket socket, const Ipv4& peer, bool udp, SteadyTime now) {
  if (full()) {
    // At most a line a second, however many call.
    if (now - last_turned_away_ > std::chrono::seconds(1))
      options_.log(
          fmt::format("{}: turned away, {} clients are the limit", peer.text(), options_.max_clients));
    last_turned_away_ = now;
    return;
  }
  peers_.push_back(
      {Connection(std::move(socket), peer,
                  {{"VRPN Control", options_.name}, udp, options_.cookie_patience, options_.message_patience},
                  now),
       peer.text(), now, period_of(options_.report_rate)});
}

void Server::take_requests(SteadyTime now) {
  std::array<std::uint8_t, datagram_limit> bytes;
  for (int k = 0; k < 16; ++k) {
    const auto datagram = receive(udp_, bytes);
    if (!datagram) return;
    const auto request = decode_dial_request(datagram->bytes);
    if (!request) continue;
    // We call back who asked, and nobody else at his word. A program on this machine may know it by another
    // address.
    const auto to = request->host == "localhost" ? std::optional(Ipv4{loopback_host, request->port})
                                                 : parse_ipv4(request->host, request->port);
    if (to && (to->host == datagram->from.host || datagram->from.loopback())) dial(*to, now);
  }
}

void Server::dial(const Ipv4& to, SteadyTime now) {
  const auto same = [&](const Ipv4& other) { return other.host == to.host && other.port == to.port; };
  // Clients ask once a second until we have called.
  for (const Dial& dialling : dials_)
    if (same(dialling.peer)) return;
  for (const Peer& peer : peers_)
    if (same(peer.connection.peer())) return;
  if (full()) return admit({}, to, true, now);
  const std::uint32_t ours = local_address(udp_).host;
  if (auto socket = dial_tcp(to, ours)) dials_.push_back({std::move(*socket), to, now});
}

void Server::finish_dials(SteadyTime now) {
  for (auto dialling = dials_.begin(); dialling != dials_.end();) {
    const bool connected = is_connected(dialling->socket);
    const bool over =
        pending_fault(dialling->socket) != LinkFault::none || now - dialling->since > dial_patience;
    if (!connected && !over) {
      ++dialling;
      continue;
    }
    Dial done = std::move(*dialling);
    dialling = dials_.erase(dialling);
    if (connected) admit(std::move(done.socket), done.peer, true, now);
  }
}

void Server::tick(SteadyTime now) {
  phantom_.tick(std::chrono::duration<double>(tick_period).count(), now);
  next_tick_ += tick_period;
  if (!phantom_.held()) holder_ = nullptr;
  tell_buttons();
  tell_too_much();
}

void Server::tell_buttons() {
  const auto& buttons = phantom_.state().buttons;
  for (std::size_t k = 0; k < buttons.size(); ++k) {
    if (buttons[k] == buttons_[k]) continue;
    Bytes payload;
    encode(payload, ButtonChange{static_cast<std::int32_t>(k), buttons[k]});
    for (Peer& peer : peers_)
      peer.connection.send(Type::button_change, device_sender, payload, Channel::reliable);
  }
  buttons_ = buttons;
}

void Server::tell_too_much() {
  const bool too_much = phantom_.state().too_much;
  if (holder_ && too_much != too_much_) {
    Bytes payload;
    encode(payload, too_much ? ForceError::force_too_high : ForceError::ok);
    holder_->connection.send(Type::force_error, device_sender, payload, Channel::reliable);
  }
  too_much_ = too_much;
}

void Server::talk(Peer& peer, SteadyTime now) {
  if (peer.welcomed && peer.next_report <= now) {
    peer.next_report = std::max(peer.next_report + peer.report_period, now);
    report(peer);
  }
  peer.connection.step(now, [&](const Received& received) { return hear(peer, received, now); });
  if (peer.connection.greeted() && !peer.welcomed) {
    peer.welcomed = true;
    peer.next_report = now;
    send_buttons(peer);
    options_.log(fmt::format("{}: connected", peer.name));
    if (peer.connection.peer_cookie().match == CookieMatch::other_minor_version)
      options_.log(
          fmt::format("{}: warning: speaks version {}", peer.name, peer.connection.peer_cookie().version));
  }
}

void Server::report(Peer& peer) {
  const PhantomState& state = phantom_.state();
  const Stamp time = Stamp::now();
  Bytes payload;
  const auto send = [&](Type type, const auto& message) {
    payload.clear();
    encode(payload, message);
    peer.connection.send(type, device_sender, payload, Channel::low_latency, time);
  };
  send(Type::pos_quat, PosQuat{0, state.position, {0, 0, 0, 1}});
  send(Type::velocity,
       Motion{0, state.velocity, {0, 0, 0, 1}, std::chrono::duration<double>(tick_period).count()});
  send(Type::force, ForceReport{state.force});
  send(Type::scp, ContactPose{state.contact.value_or(state.position), {0, 0, 0, 1}});
}

void Server::send_buttons(Peer& peer) {
  Bytes payload;
  encode(payload, std::vector<std::int32_t>(buttons_.begin(), buttons_.end()));
  peer.connection.send(Type::button_states, device_sender, payload, Channel::reliable);
}

bool Server::hear(Peer& peer, const Received& received, SteadyTime now) {
  if (received.sender != options_.name) return true;
  switch (received.type) {
    case Type::ping:
      send_buttons(peer);
      peer.connection.send(Type::pong, device_sender, {}, Channel::reliable);
      return received.payload.empty();
    case Type::set_update_rate: {
      const auto rate = decode_update_rate(received.payload);
      if (rate) peer.report_period = period_of(*rate);
      return rate.has_value();
    }
    case Type::force:
      return ask(peer, decode_force(received.payload), now);
    case Type::plane:
      return ask(peer, decode_plane(received.payload), now);
    case Type::force_field:
      return ask(peer, decode_force_field(received.payload), now);
    case Type::plane2:
      return decode_plane_effects(received.payload).has_value();
    default:
      return true;
  }
}

template <class Asked>
bool Server::ask(Peer& peer, const std::optional<Asked>& asked, SteadyTime now) {
  if (!asked) return false;
  ++force_messages_;
  if (holder_ && holder_ != &peer) {
    if (!peer.told_busy) {
      Bytes payload;
      encode(payload, Text{1, 0, "another client holds the force; yours is left out until it lets go"});
      peer.connection.send(Type::text, device_sender, payload, Channel::reliable);
    }
    peer.told_busy = true;
    return true;
  }
  phantom_.ask(*asked, now);
  holder_ = phantom_.held() ? &peer : nullptr;
  return true;
}

void Server::bury() {
  for (auto peer = peers_.begin(); peer != peers_.end();) {
    const LinkFault fault = peer->connection.fault();
    if (fault == LinkFault::none) {
      ++peer;
      continue;
    }
    if (fault == LinkFault::bad_frames) ++dropped_for_bad_frames_;
    options_.log(fmt::format("{}: {}", peer->name, meaning(fault)));
    if (holder_ == &*peer) {
      holder_ = nullptr;
      phantom_.release();
    }
    peer = peers_.erase(peer);
  }
}

}  // namespace intaglio::haptics::vrpn
