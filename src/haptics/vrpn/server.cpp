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

namespace {

constexpr double lap_time = 4;               // s
constexpr double path_duration = 12 * 3600;  // s
constexpr double velocity_cutoff = 60;       // Hz

// A circle of 3 cm, from 2 cm above the middle of the workspace to 1 cm below.
std::vector<Waypoint> circular_path() {
  std::vector<Waypoint> path;
  for (int k = 0; k * lap_time / 8 <= path_duration; ++k) {
    const double angle = k * std::numbers::pi / 4;
    path.push_back({k * lap_time / 8,
                    {0.03 * elementary::cos(angle), 0.005 + 0.015 * elementary::cos(angle),
                     0.03 * elementary::sin(angle)}});
  }
  return path;
}

}  // namespace

ServedPhantom::ServedPhantom(const PhantomOptions& options)
    : options_(options),
      device_(options.model, options.hand, options.path.empty() ? circular_path() : options.path),
      guard_(options.limits),
      requested_(options.units) {
  state_.position = device_.read();
}

void ServedPhantom::tick(double dt, SteadyTime now) {
  if (requested_.is_active() && std::chrono::duration<double>(now - requested_at_).count() > options_.silence)
    release();
  const Vec3 position = device_.read();
  const double keep = elementary::exp(-2 * std::numbers::pi * velocity_cutoff * dt);
  state_.velocity = keep * state_.velocity + (1 - keep) * (position - state_.position) / dt;
  state_.position = position;
  state_.contact = requested_.contact(position);
  const Vec3 wanted = requested_.newtons(position, state_.velocity);
  state_.over_limit = wanted.norm() > options_.limits.peak_force;
  const GuardedForce guarded = guard_.pass(wanted, dt);
  state_.force = guarded.newtons();
  device_.write(guarded);
  device_.advance(dt);
  // The hand presses the first button in the third quarter of each lap.
  state_.buttons[0] = std::fmod(device_.time(), lap_time) >= lap_time / 2 &&
                      std::fmod(device_.time(), lap_time) < 0.75 * lap_time;
}

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds tick_period{1};
// Beyond this delay the simulation loses time instead of its deadlines.
constexpr int max_ticks_per_step = 20;
constexpr std::chrono::seconds dial_patience{3};
constexpr double fastest_reports = 1000, slowest_reports = 1;  // Hz

nanoseconds period_of(double rate) {
  return nanoseconds(std::int64_t(1e9 / std::clamp(rate, slowest_reports, fastest_reports)));
}

}  // namespace

// TCP and UDP share a port; without a given one, tries for a port that is free for both.
LinkResult<std::unique_ptr<Server>> Server::open(const ServerOptions& options) {
  const LinkResult<Ipv4> at = resolve(options.bind, options.port);
  if (!at) return tl::unexpected(at.error());
  for (int attempt = 0;; ++attempt) {
    LinkResult<Socket> tcp = listen_tcp(*at);
    if (!tcp) return tl::unexpected(tcp.error());
    LinkResult<Socket> udp = bind_udp({at->host, local_address(*tcp).port});
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
  accept_calls(now);
  read_dial_requests(now);
  finish_dials(now);
  for (int k = 0; k < max_ticks_per_step && next_tick_ <= now; ++k) tick(next_tick_);
  if (next_tick_ <= now) next_tick_ = now + tick_period;
  for (Peer& peer : peers_) service(peer, now);
  remove_dead_peers();
}

void Server::accept_calls(SteadyTime now) {
  while (auto call = accept_tcp(tcp_)) add_peer(std::move(call->socket), call->peer, false, now);
}

void Server::add_peer(Socket socket, const Ipv4& peer, bool udp, SteadyTime now) {
  if (full()) {
    // At most one line per second.
    if (now - last_rejected_ > std::chrono::seconds(1))
      options_.log(fmt::format("{}: rejected: limit of {} clients", peer.text(), options_.max_clients));
    last_rejected_ = now;
    return;
  }
  peers_.push_back(
      {Connection(std::move(socket), peer,
                  {{"VRPN Control", options_.name}, udp, options_.cookie_patience, options_.message_patience},
                  now),
       peer.text(), now, period_of(options_.report_rate)});
}

void Server::read_dial_requests(SteadyTime now) {
  std::array<std::uint8_t, datagram_limit> bytes;
  for (int k = 0; k < 16; ++k) {
    const auto datagram = receive(udp_, bytes);
    if (!datagram) return;
    const auto request = decode_dial_request(datagram->bytes);
    if (!request) continue;
    // Connect back only to the requester. A program on this machine may know the machine by another address.
    const auto to = request->host == "localhost" ? std::optional(Ipv4{loopback_host, request->port})
                                                 : parse_ipv4(request->host, request->port);
    if (to && (to->host == datagram->from.host || datagram->from.loopback())) dial(*to, now);
  }
}

void Server::dial(const Ipv4& to, SteadyTime now) {
  const auto same = [&](const Ipv4& other) { return other.host == to.host && other.port == to.port; };
  // Clients repeat their request every second until we connect.
  for (const Dial& dialling : dials_)
    if (same(dialling.peer)) return;
  for (const Peer& peer : peers_)
    if (same(peer.connection.peer())) return;
  if (full()) return add_peer({}, to, true, now);
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
    if (connected) add_peer(std::move(done.socket), done.peer, true, now);
  }
}

void Server::tick(SteadyTime now) {
  phantom_.tick(std::chrono::duration<double>(tick_period).count(), now);
  next_tick_ += tick_period;
  if (!phantom_.is_held()) holder_ = nullptr;
  broadcast_buttons();
  report_over_limit();
}

void Server::broadcast_buttons() {
  const auto& buttons = phantom_.state().buttons;
  for (std::size_t k = 0; k < buttons.size(); ++k) {
    if (buttons[k] == buttons_[k]) continue;
    Bytes payload;
    encode(payload, ButtonChange{std::int32_t(k), buttons[k]});
    for (Peer& peer : peers_)
      peer.connection.send(Type::button_change, device_sender, payload, Channel::reliable);
  }
  buttons_ = buttons;
}

void Server::report_over_limit() {
  const bool over_limit = phantom_.state().over_limit;
  if (holder_ && over_limit != over_limit_) {
    Bytes payload;
    encode(payload, over_limit ? ForceError::force_too_high : ForceError::ok);
    holder_->connection.send(Type::force_error, device_sender, payload, Channel::reliable);
  }
  over_limit_ = over_limit;
}

void Server::service(Peer& peer, SteadyTime now) {
  if (peer.welcomed && peer.next_report <= now) {
    peer.next_report = std::max(peer.next_report + peer.report_period, now);
    report(peer);
  }
  peer.connection.step(now, [&](const Received& received) { return handle(peer, received, now); });
  if (peer.connection.is_established() && !peer.welcomed) {
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

bool Server::handle(Peer& peer, const Received& received, SteadyTime now) {
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
      return request(peer, decode_force(received.payload), now);
    case Type::plane:
      return request(peer, decode_plane(received.payload), now);
    case Type::force_field:
      return request(peer, decode_force_field(received.payload), now);
    case Type::plane2:
      return decode_plane_effects(received.payload).has_value();
    default:
      return true;
  }
}

template <class Request>
bool Server::request(Peer& peer, const std::optional<Request>& requested, SteadyTime now) {
  if (!requested) return false;
  ++force_messages_;
  if (holder_ && holder_ != &peer) {
    if (!peer.was_told_busy) {
      Bytes payload;
      encode(payload, Text{1, 0, "another client controls the force; yours is ignored until it releases it"});
      peer.connection.send(Type::text, device_sender, payload, Channel::reliable);
    }
    peer.was_told_busy = true;
    return true;
  }
  phantom_.request(*requested, now);
  holder_ = phantom_.is_held() ? &peer : nullptr;
  return true;
}

void Server::remove_dead_peers() {
  for (auto peer = peers_.begin(); peer != peers_.end();) {
    const LinkFault fault = peer->connection.fault();
    if (fault == LinkFault::none) {
      ++peer;
      continue;
    }
    if (fault == LinkFault::bad_frames) ++dropped_for_bad_frames_;
    options_.log(fmt::format("{}: {}", peer->name, describe(fault)));
    if (holder_ == &*peer) {
      holder_ = nullptr;
      phantom_.release();
    }
    peer = peers_.erase(peer);
  }
}

}  // namespace intaglio::haptics::vrpn
