// VRPN's state machines: a server with up to eight peers, or a client with the device that it serves, over
// socket pairs and in a time of the fuzzer's own. The bytes choose what a peer sends (a cookie, an
// introduction, messages of every type, whole, broken or cut off, datagrams), what it reads, when it hangs
// up, and how much time passes. Whatever comes, limits of clients and forces hold, and poses are finite or
// missing.
#include <fuzzer/FuzzedDataProvider.h>

#include <algorithm>

#include "fuzz/require.h"
#include "haptics/vrpn/device_link.h"
#include "haptics/vrpn/payloads.h"
#include "tests/haptics/vrpn_peers.h"

using namespace intaglio;
using namespace intaglio::haptics;
using namespace intaglio::haptics::vrpn;
using fuzz::require;

namespace {

using std::chrono::milliseconds;

// Addresses that no other program on this machine uses.
constexpr std::uint32_t fuzzed_hosts = 0x7f4d4d00;  // 127.77.77.0

template <class T>
Bytes payload_of(const T& message) {
  Bytes payload;
  encode(payload, message);
  return payload;
}

double number(FuzzedDataProvider& in) {
  static constexpr double numbers[] = {0, 1, -1, 0.01, 1e-3, -30, 1e6, 1e300, 1e-300, 20};
  return in.ConsumeBool() ? in.PickValueInArray(numbers) : in.ConsumeFloatingPoint<double>();
}
Vec3 vector(FuzzedDataProvider& in) {
  const double x = number(in), y = number(in);
  return {x, y, number(in)};
}

// A valid payload of the type, mostly.
Bytes payload_for(Type type, FuzzedDataProvider& in) {
  const auto small = [&] { return in.ConsumeIntegralInRange<std::int32_t>(-1, 300); };
  const auto single = [&] { return float(number(in)); };
  switch (type) {
    case Type::text:
      return payload_of(
          Text{in.ConsumeIntegralInRange<std::uint32_t>(0, 3), 0, in.ConsumeRandomLengthString(40)});
    case Type::pos_quat:
      return payload_of(PosQuat{small() / 100, vector(in), {number(in), 0, 0, number(in)}});
    case Type::velocity:
    case Type::acceleration:
      return payload_of(Motion{small(), vector(in), {0, 0, 0, 1}, number(in)});
    case Type::button_change:
      return payload_of(ButtonChange{small(), small()});
    case Type::button_states:
      return payload_of(std::vector<std::int32_t>(in.ConsumeIntegralInRange<std::size_t>(0, 300), small()));
    case Type::set_update_rate: {
      Bytes rate;
      put(rate, number(in));
      return rate;
    }
    case Type::force:
      return payload_of(ForceReport{vector(in)});
    case Type::plane: {
      PlaneMessage plane{.a = single(), .b = single(), .c = single(), .d = single()};
      plane.kspring = single();
      plane.kdamp = single();
      plane.index = small() / 64;
      return payload_of(plane);
    }
    case Type::force_field: {
      ForceField field;
      field.origin = vector(in).cast<float>();
      field.force = vector(in).cast<float>();
      field.radius = single();
      return payload_of(field);
    }
    case Type::scp:
      return payload_of(ContactPose{vector(in), {0, 0, 0, number(in)}});
    case Type::ping:
    case Type::pong:
      return {};
    default:
      return in.ConsumeBytes<std::uint8_t>(in.ConsumeIntegralInRange<std::size_t>(0, 64));
  }
}

Bytes system_message(FuzzedDataProvider& in) {
  Bytes out, payload;
  const auto id = in.ConsumeIntegralInRange<std::int32_t>(-1, id_limit);
  if (in.ConsumeBool()) {
    encode_udp_host(payload,
                    Ipv4{fuzzed_hosts + in.ConsumeIntegralInRange<std::uint32_t>(0, 2), 0}.host_text());
    append_message(out, {{}, 32 * id, udp_description, 0, payload});
  } else {
    encode_name(payload, in.ConsumeRandomLengthString(name_limit));
    append_message(out, {{}, id, in.ConsumeIntegralInRange<std::int32_t>(-6, -1), 0, payload});
  }
  return out;
}

// All that a peer sends in one turn.
Bytes utterance(FuzzedDataProvider& in) {
  const auto cookie = our_cookie();
  Bytes out;
  switch (in.ConsumeIntegralInRange(0, 7)) {
    case 0:
      return {cookie.begin(), cookie.end()};
    case 1: {
      out.assign(cookie.begin(), cookie.end());
      const Bytes names = introduction();
      out.insert(out.end(), names.begin(), names.end());
      return out;
    }
    case 2:
      return introduction();
    case 3:
      return in.ConsumeBytes<std::uint8_t>(in.ConsumeIntegralInRange<std::size_t>(0, 2000));
    case 4:
      return system_message(in);
    case 5:  // many at once: more than a buffer, if they are many
      for (std::size_t k = in.ConsumeIntegralInRange<std::size_t>(0, 3000); k > 0; --k)
        append_message(out, {{}, 0, std::int32_t(Type::ping), 0, {}});
      return out;
    default: {
      const Type type = Type(in.ConsumeIntegralInRange<std::int32_t>(0, int(type_names.size()) - 1));
      append_message(out, {{}, 0, std::int32_t(type), 0, payload_for(type, in)});
      if (in.ConsumeIntegralInRange(0, 15) == 0)
        out[in.ConsumeIntegralInRange<std::size_t>(0, 23)] = in.ConsumeIntegral<std::uint8_t>();
      if (in.ConsumeIntegralInRange(0, 15) == 0)
        out.resize(in.ConsumeIntegralInRange<std::size_t>(0, out.size()));
      return out;
    }
  }
}

struct Pair {
  Socket ours, theirs;
};
Pair socket_pair() {
  int both[2] = {-1, -1};
  require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, both) == 0);
  return {Socket(both[0]), Socket(both[1])};
}

void say(const Socket& to, const Bytes& bytes) {
  if (to) ::send(to.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
}
void listen(const Socket& to, std::size_t most) {
  std::array<std::uint8_t, 65536> buffer;
  if (to) ::recv(to.fd(), buffer.data(), std::min(most, buffer.size()), 0);
}
milliseconds some_time(FuzzedDataProvider& in) {
  return milliseconds(in.PickValueInArray({0, 0, 1, 1, 5, 50, 400, 1100, 3100, 5100, 31000}));
}

void serve(FuzzedDataProvider& in) {
  ServerOptions options;
  options.port = 0;
  options.max_clients = 5;
  options.max_clients_per_host = 3;
  options.phantom.path = {{0, {0, 0.02, 0}}, {0.01, {0.01, 0, 0}}, {1, {0, -0.01, 0}}};
  options.log = [](const std::string& line) { require(line.find('\n') == std::string::npos); };
  SteadyTime now = std::chrono::steady_clock::now();
  const auto server = std::move(*Server::open(options));
  std::array<Socket, 8> peers;
  const Socket caller = std::move(*connect_udp({loopback_host, server->port()}));
  for (int turn = 0; turn < 500 && in.remaining_bytes() > 0; ++turn) {
    Socket& peer = peers[in.ConsumeIntegralInRange<std::size_t>(0, peers.size() - 1)];
    const int act = in.ConsumeIntegralInRange(0, 15);
    if (act == 0) {
      peer = Socket();  // hangs up
    } else if (act == 1) {
      Bytes request;
      encode_dial_request(request, {Ipv4{fuzzed_hosts, 0}.host_text(), in.ConsumeIntegral<std::uint16_t>()});
      send_datagram(caller, request);
    } else if (act < 5) {
      listen(peer, std::size_t{1} << in.ConsumeIntegralInRange(0, 16));
    } else {
      if (!peer) {
        Pair pair = socket_pair();
        peer = std::move(pair.ours);
        const std::uint32_t host = fuzzed_hosts + in.ConsumeIntegralInRange<std::uint32_t>(0, 2);
        server->take({std::move(pair.theirs), {host, 1024 + turn}}, now);
      }
      say(peer, utterance(in));
    }
    now += some_time(in);
    server->step(now);
    require(server->clients() <= options.max_clients);
    const PhantomState& phantom = server->phantom();
    require(phantom.position.allFinite() && phantom.velocity.allFinite());
    require(phantom.force.norm() <= options.phantom.limits.peak_force * (1 + 1e-9));
  }
}

void be_served(FuzzedDataProvider& in) {
  VrpnDeviceOptions options;
  options.force_mode = in.PickValueInArray({ForceMode::field, ForceMode::plane, ForceMode::force});
  SteadyTime now = std::chrono::steady_clock::now();
  Pair pair = socket_pair();
  Socket server = std::move(pair.ours);
  const Ipv4 host{fuzzed_hosts, default_port};
  Client client({"Phantom0", "fuzz", default_port, in.ConsumeBool()}, std::move(pair.theirs), host, now);
  DeviceLink link(options);
  link.begin();
  for (int turn = 0; turn < 500 && in.remaining_bytes() > 0 && client.fault() == LinkFault::none; ++turn) {
    const int act = in.ConsumeIntegralInRange(0, 15);
    const Socket& udp = client.connection().udp();
    if (act == 0) {
      server = Socket();
    } else if (act == 1 && udp) {
      const Socket from = std::move(*bind_udp({fuzzed_hosts, 0}));
      if (const auto to = connect_udp({loopback_host, local_address(udp).port}))
        send_datagram(*to, utterance(in));
    } else if (act < 5) {
      listen(server, std::size_t{1} << in.ConsumeIntegralInRange(0, 16));
    } else if (act < 8) {
      link.write(vector(in), now);
    } else {
      say(server, utterance(in));
    }
    now += some_time(in);
    client.step_at(now, [&](const Received& received) { return link.handle(received, now); });
    link.forward(client, now);
    const Vec3 position = link.read(now);
    require(position.allFinite() || position.hasNaN());
    require(link.orientation().coeffs().allFinite() && link.silent_for(now) >= 0);
  }
  link.end(client);
  require(link.read(now).hasNaN());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider in(data, size);
  in.ConsumeBool() ? serve(in) : be_served(in);
  return 0;
}
