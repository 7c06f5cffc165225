// What a VRPN client asks the hand to feel: a force, up to four planes, a force field; and what that comes to
// at a place. Not guarded: whoever displays it passes it through a Guard.
//
// Planes are damped springs that push and never pull (plane_force()); their friction and effects are taken
// note of but not displayed. Numbers were checked when they were decoded. No allocation. One thread.
#pragma once

#include <array>
#include <optional>

#include "intaglio/haptics/devices/vrpn/force_messages.h"

namespace intaglio::haptics::vrpn {

// What a driver's own units of a plane are in SI. Defaults: newtons a millimetre, as the usual 0.8 of clients
// means.
struct PlaneUnits {
  double stiffness = 1000;  // N/m a unit of kspring
  double damping = 1000;    // N s/m a unit of kdamp
};

class AskedForce {
 public:
  explicit AskedForce(const PlaneUnits& units) : units_(units) {}

  void set(const ForceReport& force) { force_ = force.newtons; }
  void set(const PlaneMessage& plane);
  void set(const ForceField& field);
  void clear();
  // Whether anything is asked for.
  bool any() const;

  // N at the tip's position (m) and velocity (m/s), device frame.
  Vec3 newtons(const Vec3& x, const Vec3& v) const;
  // Where the tip touches: its projection on the plane that it is deepest in.
  std::optional<Vec3> contact(const Vec3& x) const;

 private:
  PlaneUnits units_;
  Vec3 force_ = Vec3::Zero();
  std::array<std::optional<PlaneMessage>, plane_limit> planes_;
  std::optional<ForceField> field_;
};

}  // namespace intaglio::haptics::vrpn
