#include "haptics/vrpn/vrpn_device.h"

#include <limits>

#include "haptics/vrpn/payloads.h"

namespace intaglio::haptics::vrpn {

static constexpr std::chrono::microseconds link_period{500};
static constexpr std::chrono::milliseconds redial_period{1000};

static std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

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
  return at < 0 ? std::numeric_limits<double>::infinity() : 1e-9 * static_cast<double>(steady_now() - at);
}

Vec3 VrpnDevice::read() {
  if (!(silent_for() <= options_.silence)) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  heard_.update();
  last_tip_ = heard_.value().position;
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

LinkFailure VrpnDevice::last_failure() const {
  const std::lock_guard lock(failure_mutex_);
  return failure_;
}

void VrpnDevice::remember(const LinkFailure& failure) {
  const std::lock_guard lock(failure_mutex_);
  failure_ = failure;
}

void VrpnDevice::run() {
  while (!stopped_) {
    auto client = Client::connect(address_, options_.client);
    if (client) {
      serve(**client);
      remember({(*client)->fault(), {address_.text(), std::string(meaning((*client)->fault())), ""}});
    } else {
      remember(client.error());
    }
    const auto redial = std::chrono::steady_clock::now() + redial_period;
    while (!stopped_ && std::chrono::steady_clock::now() < redial)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void VrpnDevice::serve(Client& client) {
  holding_ = plane_started_ = false;
  wanted_.update();
  forwarded_ = wanted_.value().time;  // what was written before the link was there is out of date
  while (!stopped_ && client.fault() == LinkFault::none) {
    client.step(link_period, [this](const Received& received) { return hear(received); });
    forward(client);
  }
  heard_at_.store(-1, std::memory_order_release);
  buttons_ = 0;
  if (holding_) let_go(client);
  client.step({}, [](const Received&) { return true; });
}

bool VrpnDevice::hear(const Received& received) {
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
    if (change) press(static_cast<std::size_t>(change->button), change->state != 0);
    return change.has_value();
  }
  if (received.type == Type::button_states) {
    const auto states = decode_button_states(received.payload);
    for (std::size_t k = 0; states && k < states->size(); ++k) press(k, (*states)[k] != 0);
    return states.has_value();
  }
  // Nothing else is needed; drivers are known to send reports of contact with numbers that were never set.
  return true;
}

void VrpnDevice::forward(Client& client) {
  wanted_.update();
  const Wanted& wanted = wanted_.value();
  const bool stale = 1e-9 * static_cast<double>(steady_now() - wanted.time) > options_.silence;
  const bool lost = !(silent_for() <= options_.silence);
  if (stale || lost || wanted.force.isZero(0)) {
    if (holding_) let_go(client);
    return;
  }
  if (wanted.time == forwarded_) return;
  forwarded_ = wanted.time;
  display(client, wanted);
  holding_ = true;
}

void VrpnDevice::display(Client& client, const Wanted& wanted) {
  Bytes payload;
  if (options_.force_by == ForceBy::force) {
    encode(payload, ForceReport{wanted.force});
    client.send(Type::force, payload, Channel::low_latency);
    return;
  }
  if (options_.force_by == ForceBy::field) {
    ForceField field;
    field.origin = wanted.tip.cast<float>();
    field.force = wanted.force.cast<float>();
    field.radius = 1;  // m: the whole workspace
    encode(payload, field);
    client.send(Type::force_field, payload, Channel::low_latency);
    return;
  }
  // The tip is as deep behind the plane as the spring asks for this force.
  const double size = wanted.force.norm();
  const Vec3 n = wanted.force / size;
  PlaneMessage plane;
  plane.a = static_cast<float>(n.x());
  plane.b = static_cast<float>(n.y());
  plane.c = static_cast<float>(n.z());
  plane.d = static_cast<float>(-(n.dot(wanted.tip) + size / options_.plane_stiffness));
  plane.kspring = static_cast<float>(options_.plane_stiffness / options_.units.stiffness);
  plane.kdamp = static_cast<float>(options_.plane_damping / options_.units.damping);
  encode(payload, plane);
  // The start goes by TCP; updates in one datagram with the plane's effects.
  client.send(Type::plane, payload, plane_started_ ? Channel::low_latency : Channel::reliable);
  plane_started_ = true;
  payload.clear();
  encode(payload, PlaneEffects{});
  client.send(Type::plane2, payload, Channel::low_latency);
}

void VrpnDevice::let_go(Client& client) {
  Bytes payload;
  Type type = Type::force;
  if (options_.force_by == ForceBy::field) {
    encode(payload, ForceField{});
    type = Type::force_field;
  } else if (options_.force_by == ForceBy::plane) {
    encode(payload, PlaneMessage{});
    type = Type::plane;
  } else {
    encode(payload, ForceReport{});
  }
  client.send(type, payload, Channel::reliable);
  holding_ = plane_started_ = false;
}

}  // namespace intaglio::haptics::vrpn
