#include "haptics/vrpn/server.h"

#include <fmt/format.h>
#include <algorithm>
#include <thread>

#include "haptics/vrpn/client.h"
#include "haptics/vrpn/message.h"
#include "haptics/vrpn/payloads.h"

namespace intaglio::haptics::vrpn {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds tick_period{1};
// Beyond this delay the simulation loses time instead of its deadlines.
constexpr int max_ticks_per_step = 20;
constexpr std::chrono::seconds served_while{5};                // since it was last alive
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
      log_(options.log),
      door_(options.log),
      callers_(options.cookie_patience),
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
  callers_.step(
      now, [&](Caller caller) { admit(std::move(caller), now); }, say_lost(now));
  for (int k = 0; k < max_ticks_per_step && next_tick_ <= now; ++k) tick(next_tick_);
  if (next_tick_ <= now) next_tick_ = now + tick_period;
  for (Peer& peer : peers_) service(peer, now);
  remove_dead_peers(now);
  log_.step(now);
  door_.step(now);
}

void Server::accept_calls(SteadyTime now) {
  for (std::size_t k = 0; k < Callers::limit; ++k) {
    auto accepted = accept_tcp(tcp_);
    if (!accepted) return;
    take(std::move(*accepted), now);
  }
}

void Server::take(Accepted accepted, SteadyTime now) {
  call({std::move(accepted.socket), accepted.peer, false, now}, now);
}

void Server::call(Caller caller, SteadyTime now) {
  callers_.add(std::move(caller), say_lost(now));
}

Callers::Lost Server::say_lost(SteadyTime now) {
  return [this, now](const Caller& lost, LinkFault why) {
    door_.line(now, fmt::format("{}: {}", lost.peer.text(), describe(why)));
  };
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
  // Clients repeat their request every second until we connect.
  if (callers_.contains(to)) return;
  for (const Peer& peer : peers_)
    if (peer.connection.peer() == to) return;
  if (auto socket = dial_tcp(to, local_address(udp_).host)) call({std::move(*socket), to, true, now}, now);
}

void Server::admit(Caller caller, SteadyTime now) {
  if (!make_room(caller.peer, now)) return;
  peers_.push_back({Connection(std::move(caller.socket), caller.peer,
                               {.senders = {"VRPN Control", options_.name},
                                .udp = caller.udp,
                                .cookie_patience = options_.cookie_patience,
                                .message_patience = options_.message_patience,
                                .idle_patience = options_.idle_patience},
                               now),
                    caller.peer.text(), now, period_of(options_.report_rate)});
}

// Without room, the client goes that has been idle for longest, or else is the oldest, of those not served.
bool Server::make_room(const Ipv4& newcomer, SteadyTime now) {
  const auto is_neighbour = [&](const Peer& peer) { return peer.connection.peer().host == newcomer.host; };
  const auto neighbours = std::size_t(std::count_if(peers_.begin(), peers_.end(), is_neighbour));
  const bool is_host_full = neighbours >= options_.max_clients_per_host;
  if (!is_host_full && peers_.size() < options_.max_clients) return true;
  auto idlest = peers_.end();
  for (auto peer = peers_.begin(); peer != peers_.end(); ++peer) {
    if (is_served(*peer, now) || (is_host_full && !is_neighbour(*peer))) continue;
    if (idlest == peers_.end() || peer->connection.alive_at() < idlest->connection.alive_at()) idlest = peer;
  }
  if (idlest != peers_.end()) {
    remove(idlest, LinkFault::crowded, now);
    return true;
  }
  door_.line(now, fmt::format("{}: rejected: limit of {} clients{}", newcomer.text(),
                              is_host_full ? options_.max_clients_per_host : options_.max_clients,
                              is_host_full ? " from one address" : ""));
  return false;
}

bool Server::is_served(const Peer& peer, SteadyTime now) const {
  const bool has_introduced_itself = !peer.connection.peer_names().senders().empty();
  return &peer == holder_ || (has_introduced_itself && now - peer.connection.alive_at() < served_while);
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
    log_.line(now, fmt::format("{}: connected{}", peer.name,
                               peer.connection.peer_cookie().match == CookieMatch::other_minor_version
                                   ? fmt::format("; warning: it speaks version {}",
                                                 peer.connection.peer_cookie().version)
                                   : ""));
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

void Server::remove(std::list<Peer>::iterator peer, LinkFault why, SteadyTime now) {
  if (why == LinkFault::bad_frames) ++dropped_for_bad_frames_;
  log_.line(now, fmt::format("{}: {}", peer->name, describe(why)));
  if (holder_ == &*peer) {
    holder_ = nullptr;
    phantom_.release();
  }
  peers_.erase(peer);
}

void Server::remove_dead_peers(SteadyTime now) {
  for (auto peer = peers_.begin(); peer != peers_.end();) {
    const auto dead = peer++;
    if (dead->connection.fault() != LinkFault::none) remove(dead, dead->connection.fault(), now);
  }
}

}  // namespace intaglio::haptics::vrpn
