// Payloads of force device messages, and the force that a client requests by them.
//
// Decoders return nothing for a wrong size, a plane or error out of range, or a number that is not finite.
// Metres and newtons; kspring and kdamp are in the driver's own units.
#pragma once

#include <array>
#include <optional>

#include "haptics/vrpn/payloads.h"

namespace intaglio::haptics::vrpn {

inline constexpr std::int32_t plane_limit = 4;

struct ForceReport {
  Vec3 newtons = Vec3::Zero();
};

// Surface contact point.
struct ContactPose {
  Vec3 position = Vec3::Zero();  // m
  WireQuat quat = {0, 0, 0, 1};
};

// ax + by + cz + d = 0 in metres; a = b = c = 0 switches the plane off.
struct PlaneMessage {
  float a = 0, b = 0, c = 0, d = 0;
  float kspring = 0.8f, kdamp = 0.001f, fdyn = 0, fstat = 0;
  std::int32_t index = 0;            // 0..3
  std::int32_t recovery_cycles = 1;  // ignored by servers

  bool off() const { return a == 0 && b == 0 && c == 0; }
};

// Optional effects of a plane.
struct PlaneEffects {
  float adhesion_normal = 0, adhesion_lateral = 0;
  float texture_amplitude = 0, texture_wavelength = 0;
  float buzz_amplitude = 0, buzz_frequency = 0;
};

// force + jacobian (x - origin) within `radius` of the origin.
struct ForceField {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero(), force = Eigen::Vector3f::Zero();
  Eigen::Matrix3f jacobian = Eigen::Matrix3f::Zero();
  float radius = 0;  // m
};

enum class ForceError : std::int32_t { out_of_range, duty_cycle, force_too_high, misc, ok };
std::string_view describe(ForceError error);

std::optional<ForceReport> decode_force(View payload);
std::optional<ContactPose> decode_scp(View payload);
std::optional<PlaneMessage> decode_plane(View payload);
std::optional<PlaneEffects> decode_plane_effects(View payload);
std::optional<ForceField> decode_force_field(View payload);
std::optional<ForceError> decode_force_error(View payload);

void encode(Bytes& out, const ForceReport& force);
void encode(Bytes& out, const ContactPose& contact);
void encode(Bytes& out, const PlaneMessage& plane);
void encode(Bytes& out, const PlaneEffects& effects);
void encode(Bytes& out, const ForceField& field);
void encode(Bytes& out, ForceError error);

// A driver's units of stiffness and damping in SI. Defaults: per millimetre, matching the usual kspring of
// 0.8.
struct PlaneUnits {
  double stiffness = 1000;  // N/m per unit of kspring
  double damping = 1000;    // N s/m per unit of kdamp
};

// The force requested by a VRPN client: a force, up to four planes, a force field. Unguarded: pass it through
// a Guard.
//
// Planes are damped springs that push and never pull (plane_force()); their friction and effects are parsed
// but not rendered. Numbers were checked when they were decoded. No allocation. One thread.
class RequestedForce {
 public:
  explicit RequestedForce(const PlaneUnits& units) : units_(units) {}

  void set(const ForceReport& force) { force_ = force.newtons; }
  void set(const PlaneMessage& plane);
  void set(const ForceField& field);
  void clear();
  // Whether anything is requested.
  bool is_active() const;

  // N at the tip's position (m) and velocity (m/s), device frame.
  Vec3 newtons(const Vec3& x, const Vec3& v) const;
  // The tip's projection onto the plane that it is deepest in; none outside all planes.
  std::optional<Vec3> contact(const Vec3& x) const;

 private:
  PlaneUnits units_;
  Vec3 force_ = Vec3::Zero();
  std::array<std::optional<PlaneMessage>, plane_limit> planes_;
  std::optional<ForceField> field_;
};

}  // namespace intaglio::haptics::vrpn
