#include "haptics/vrpn/vrpn_device.h"

#include <limits>

#include "haptics/vrpn/payloads.h"

namespace intaglio::haptics::vrpn {

namespace {

constexpr std::chrono::microseconds link_period{500};
constexpr std::chrono::milliseconds redial_period{1000};

std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

VrpnDevice::VrpnDevice(const Address& address, const VrpnDeviceOptions& options)
    : address_(address), options_(options) {
  options_.client.stopped = &stopped_;
  thread_ = std::thread([this] { run(); });
}

VrpnDevice::~VrpnDevice() {
  stopped_ = true;
  thread_.join();
}

double VrpnDevice::silent_for() const {
  const std::int64_t at = heard_at_.load(std::memory_order_acquire);
  return at < 0 ? std::numeric_limits<double>::infinity() : 1e-9 * double(steady_now() - at);
}

Vec3 VrpnDevice::read() {
  if (!(silent_for() <= options_.silence)) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  last_tip_ = heard_.fetch().position;
  return last_tip_;
}

void VrpnDevice::write(const GuardedForce& force) {
  wanted_.publish({force.newtons(), last_tip_, steady_now()});
}

bool VrpnDevice::wait_for_link(std::chrono::milliseconds patience) const {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!(silent_for() <= options_.silence)) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

LinkError VrpnDevice::last_failure() const {
  const std::lock_guard lock(failure_mutex_);
  return failure_;
}

void VrpnDevice::record_failure(const LinkError& failure) {
  const std::lock_guard lock(failure_mutex_);
  failure_ = failure;
}

void VrpnDevice::run() {
  while (!stopped_) {
    auto client = Client::connect(address_, options_.client);
    if (client) {
      serve(**client);
      record_failure({(*client)->fault(), {address_.text(), std::string(describe((*client)->fault())), ""}});
    } else {
      record_failure(client.error());
    }
    const auto redial = std::chrono::steady_clock::now() + redial_period;
    while (!stopped_ && std::chrono::steady_clock::now() < redial)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void VrpnDevice::serve(Client& client) {
  holding_ = plane_started_ = false;
  forwarded_ = wanted_.fetch().time;  // a force written before the link was up is out of date
  while (!stopped_ && client.fault() == LinkFault::none) {
    client.step(link_period, [this](const Received& received) { return handle(received); });
    forward(client);
  }
  heard_at_.store(-1, std::memory_order_release);
  buttons_ = 0;
  if (holding_) release(client);
  client.step({}, [](const Received&) { return true; });
}

bool VrpnDevice::handle(const Received& received) {
  if (received.type == Type::pos_quat) {
    const auto pose = decode_pos_quat(received.payload);
    if (!pose) return false;
    if (pose->sensor != options_.sensor) return true;
    heard_.publish({pose->position, vrpn::orientation(pose->quat)});
    heard_at_.store(steady_now(), std::memory_order_release);
    return true;
  }
  const auto press = [this](std::size_t button, bool pressed) {
    if (button >= 32) return;
    const std::uint32_t bit = 1u << button;
    buttons_ = pressed ? buttons_ | bit : buttons_ & ~bit;
  };
  if (received.type == Type::button_change) {
    const auto change = decode_button_change(received.payload);
    if (change) press(std::size_t(change->button), change->state != 0);
    return change.has_value();
  }
  if (received.type == Type::button_states) {
    const auto states = decode_button_states(received.payload);
    for (std::size_t k = 0; states && k < states->size(); ++k) press(k, (*states)[k] != 0);
    return states.has_value();
  }
  // Other messages are ignored unchecked: drivers are known to send contact points with uninitialised
  // numbers.
  return true;
}

void VrpnDevice::forward(Client& client) {
  const Wanted& wanted = wanted_.fetch();
  const bool stale = 1e-9 * double(steady_now() - wanted.time) > options_.silence;
  const bool lost = !(silent_for() <= options_.silence);
  if (stale || lost || wanted.force.isZero(0)) {
    if (holding_) release(client);
    return;
  }
  if (wanted.time == forwarded_) return;
  forwarded_ = wanted.time;
  display(client, wanted);
  holding_ = true;
}

void VrpnDevice::display(Client& client, const Wanted& wanted) {
  Bytes payload;
  if (options_.force_mode == ForceMode::force) {
    encode(payload, ForceReport{wanted.force});
    client.send(Type::force, payload, Channel::low_latency);
    return;
  }
  if (options_.force_mode == ForceMode::field) {
    ForceField field;
    field.origin = wanted.tip.cast<float>();
    field.force = wanted.force.cast<float>();
    field.radius = 1;  // m: the whole workspace
    encode(payload, field);
    client.send(Type::force_field, payload, Channel::low_latency);
    return;
  }
  // Place the plane so far in front of the tip that its spring gives this force.
  const double size = wanted.force.norm();
  const Vec3 n = wanted.force / size;
  PlaneMessage plane;
  plane.a = float(n.x());
  plane.b = float(n.y());
  plane.c = float(n.z());
  plane.d = float(-(n.dot(wanted.tip) + size / options_.plane_stiffness));
  plane.kspring = float(options_.plane_stiffness / options_.units.stiffness);
  plane.kdamp = float(options_.plane_damping / options_.units.damping);
  encode(payload, plane);
  // The first plane goes by TCP; updates go in one datagram with the plane's effects.
  client.send(Type::plane, payload, plane_started_ ? Channel::low_latency : Channel::reliable);
  plane_started_ = true;
  payload.clear();
  encode(payload, PlaneEffects{});
  client.send(Type::plane2, payload, Channel::low_latency);
}

void VrpnDevice::release(Client& client) {
  Bytes payload;
  Type type = Type::force;
  if (options_.force_mode == ForceMode::field) {
    encode(payload, ForceField{});
    type = Type::force_field;
  } else if (options_.force_mode == ForceMode::plane) {
    encode(payload, PlaneMessage{});
    type = Type::plane;
  } else {
    encode(payload, ForceReport{});
  }
  client.send(type, payload, Channel::reliable);
  holding_ = plane_started_ = false;
}

}  // namespace intaglio::haptics::vrpn
