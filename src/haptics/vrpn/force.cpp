#include "haptics/vrpn/force.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "haptics/held_plane.h"

namespace intaglio::haptics::vrpn {

namespace {

// N finite floats.
template <std::size_t N>
std::optional<std::array<float, N>> read_floats(Reader& reader) {
  std::array<float, N> values;
  bool finite = true;
  for (float& value : values) {
    value = reader.f32();
    finite = finite && std::isfinite(value);
  }
  return reader.ok() && finite ? std::optional(values) : std::nullopt;
}

}  // namespace

std::string_view describe(ForceError error) {
  switch (error) {
    case ForceError::out_of_range:
      return "a value is out of range";
    case ForceError::duty_cycle:
      return "the servo loop overran its duty cycle";
    case ForceError::force_too_high:
      return "the force is too high";
    case ForceError::misc:
      return "device error";
    case ForceError::ok:
      return "ok";
  }
  return "";
}

std::optional<ForceReport> decode_force(View payload) {
  Reader reader(payload);
  const ForceReport force{reader.vec3()};
  if (!reader.at_end() || !force.newtons.allFinite()) return std::nullopt;
  return force;
}

std::optional<ContactPose> decode_scp(View payload) {
  Reader reader(payload);
  const Vec3 position = reader.vec3();
  const auto quat = read_quat(reader);
  if (!reader.at_end() || !position.allFinite() || !quat) return std::nullopt;
  return ContactPose{position, *quat};
}

std::optional<PlaneMessage> decode_plane(View payload) {
  Reader reader(payload);
  const auto f = read_floats<8>(reader);
  const std::int32_t index = reader.i32(), recovery_cycles = reader.i32();
  if (!f || !reader.at_end() || index < 0 || index >= plane_limit) return std::nullopt;
  const auto& v = *f;
  return PlaneMessage{v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], index, recovery_cycles};
}

std::optional<PlaneEffects> decode_plane_effects(View payload) {
  Reader reader(payload);
  const auto f = read_floats<6>(reader);
  if (!f || !reader.at_end()) return std::nullopt;
  const auto& v = *f;
  return PlaneEffects{v[0], v[1], v[2], v[3], v[4], v[5]};
}

std::optional<ForceField> decode_force_field(View payload) {
  Reader reader(payload);
  const auto f = read_floats<16>(reader);
  if (!f || !reader.at_end() || (*f)[15] < 0) return std::nullopt;
  const auto& v = *f;
  ForceField field;
  field.origin = {v[0], v[1], v[2]};
  field.force = {v[3], v[4], v[5]};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      field.jacobian(row, column) = v[std::size_t(6 + 3 * row + column)];
  field.radius = v[15];
  return field;
}

std::optional<ForceError> decode_force_error(View payload) {
  Reader reader(payload);
  const std::int32_t code = reader.i32();
  if (!reader.at_end() || code < 0 || code > std::int32_t(ForceError::ok)) return std::nullopt;
  return static_cast<ForceError>(code);
}

void encode(Bytes& out, const ForceReport& force) {
  put(out, force.newtons);
}

void encode(Bytes& out, const ContactPose& contact) {
  put(out, contact.position);
  put_quat(out, contact.quat);
}

void encode(Bytes& out, const PlaneMessage& p) {
  for (const float value : {p.a, p.b, p.c, p.d, p.kspring, p.kdamp, p.fdyn, p.fstat}) put(out, value);
  put(out, p.index);
  put(out, p.recovery_cycles);
}

void encode(Bytes& out, const PlaneEffects& e) {
  for (const float value : {e.adhesion_normal, e.adhesion_lateral, e.texture_amplitude, e.texture_wavelength,
                            e.buzz_amplitude, e.buzz_frequency})
    put(out, value);
}

void encode(Bytes& out, const ForceField& field) {
  for (int k = 0; k < 3; ++k) put(out, field.origin[k]);
  for (int k = 0; k < 3; ++k) put(out, field.force[k]);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) put(out, field.jacobian(row, column));
  put(out, field.radius);
}

void encode(Bytes& out, ForceError error) {
  put(out, std::int32_t(error));
}

namespace {

// The plane a x + b y + c z + d = 0 with its normal scaled to 1. Squares of any float fit in a double.
Plane unit_plane(const PlaneMessage& message) {
  const Vec3 normal(message.a, message.b, message.c);
  const double length = normal.norm();
  return {normal / length, -message.d / length};
}

}  // namespace

void RequestedForce::set(const PlaneMessage& plane) {
  auto& slot = planes_[std::size_t(plane.index)];
  slot = plane.off() ? std::nullopt : std::optional(plane);
}

void RequestedForce::set(const ForceField& field) {
  const bool is_zero = field.force.isZero(0) && field.jacobian.isZero(0);
  field_ = is_zero ? std::nullopt : std::optional(field);
}

void RequestedForce::clear() {
  *this = RequestedForce(units_);
}

bool RequestedForce::is_active() const {
  return !force_.isZero(0) || field_ ||
         std::any_of(planes_.begin(), planes_.end(), [](const auto& plane) { return plane.has_value(); });
}

Vec3 RequestedForce::newtons(const Vec3& x, const Vec3& v) const {
  Vec3 sum = force_;
  for (const auto& plane : planes_) {
    if (!plane) continue;
    const Spring spring{std::max(0.0, units_.stiffness * plane->kspring),
                        std::max(0.0, units_.damping * plane->kdamp)};
    sum += plane_force(unit_plane(*plane), spring, x, v);
  }
  if (field_) {
    const Vec3 from_origin = x - field_->origin.cast<double>();
    if (from_origin.norm() <= field_->radius)
      sum += field_->force.cast<double>() + field_->jacobian.cast<double>() * from_origin;
  }
  return sum;
}

std::optional<Vec3> RequestedForce::contact(const Vec3& x) const {
  std::optional<Vec3> point;
  double deepest = 0;
  for (const auto& message : planes_) {
    if (!message) continue;
    const Plane plane = unit_plane(*message);
    const double depth = -plane.distance(x);
    if (depth <= deepest) continue;
    deepest = depth;
    point = x + depth * plane.normal;
  }
  return point;
}

}  // namespace intaglio::haptics::vrpn
