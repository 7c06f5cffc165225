#include "haptics/vrpn/device_link.h"

#include "haptics/vrpn/payloads.h"

namespace intaglio::haptics::vrpn {

Vec3 DeviceLink::read(SteadyTime now) {
  if (!(silent_for(now) <= options_.silence)) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  last_tip_ = heard_.fetch().position;
  return last_tip_;
}

void DeviceLink::write(const Vec3& newtons, SteadyTime now) {
  wanted_.publish({newtons, last_tip_, now});
}

double DeviceLink::silent_for(SteadyTime now) const {
  const SteadyTime::rep at = heard_at_.load(std::memory_order_acquire);
  if (at < 0) return std::numeric_limits<double>::infinity();
  return std::chrono::duration<double>(now - SteadyTime(SteadyTime::duration(at))).count();
}

void DeviceLink::begin() {
  holding_ = plane_started_ = false;
  forwarded_ = wanted_.fetch().time;
}

void DeviceLink::end(Client& client) {
  heard_at_.store(-1, std::memory_order_release);
  buttons_ = 0;
  if (holding_) release(client);
}

bool DeviceLink::handle(const Received& received, SteadyTime now) {
  if (received.type == Type::pos_quat) {
    const auto pose = decode_pos_quat(received.payload);
    if (!pose) return false;
    if (pose->sensor != options_.sensor) return true;
    heard_.publish({pose->position, vrpn::orientation(pose->quat)});
    heard_at_.store(now.time_since_epoch().count(), std::memory_order_release);
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

void DeviceLink::forward(Client& client, SteadyTime now) {
  const Wanted& wanted = wanted_.fetch();
  const bool stale = std::chrono::duration<double>(now - wanted.time).count() > options_.silence;
  const bool lost = !(silent_for(now) <= options_.silence);
  if (stale || lost || wanted.force.isZero(0)) {
    if (holding_) release(client);
    return;
  }
  if (wanted.time == forwarded_) return;
  forwarded_ = wanted.time;
  display(client, wanted);
  holding_ = true;
}

void DeviceLink::display(Client& client, const Wanted& wanted) {
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

void DeviceLink::release(Client& client) {
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
