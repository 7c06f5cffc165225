// How a ball and a pen move on the reference: rigid bodies on a brute-force relief at 3,840 Hz.
//
// Independent of dynamics/ and haptics/: no Bullet, no proxy of ours; the laws are the same (Coulomb
// friction, restitution, rolling resistance, a spring between hand and tip). SI units, local coordinates of
// the surface (z up, out of it); the surface is horizontal. Deterministic. About 30 us a step of the ball.
#pragma once

#include <vector>

#include "evaluate/mesh_floor.h"
#include "evaluate/reference.h"
#include "intaglio/material.h"

namespace intaglio::evaluate {

inline constexpr double reference_rate = 3840;  // Hz

// A ball; its state in local coordinates.
class ReferenceBall {
 public:
  ReferenceBall(const Reference& truth, double radius, const Material& ball, const Material& floor,
                double rate = reference_rate);

  void put(const BodyState& state) { state_ = state; }
  const BodyState& state() const { return state_; }
  void step();
  bool touches() const { return touches_; }
  std::vector<TouchPoint> touch_points() const;  // of the last step
  // Normals of the contacts, nearest first, of a ball there.
  std::vector<Vec3> normals_at(const Vec3& centre) const;
  // Kinetic and potential energy, J.
  double energy() const;

 private:
  struct Contact {
    Vec3 normal, arm;    // unit, towards the ball; from the centre to the point
    double gap, wanted;  // m; least normal velocity, m/s
    double normal_impulse = 0;
    Vec3 friction_impulse = Vec3::Zero();
  };
  void find_contacts();
  void solve();
  void resist_rolling(double normal_impulse);

  const Reference& truth_;
  double radius_, mass_, inertia_, friction_, restitution_, rolling_, dt_;
  BodyState state_;
  std::vector<Contact> contacts_;
  bool touches_ = false;
};

// The tip of a pen that a spring ties to the hand: it slides over the relief, never into it, and sticks
// within the cone of friction (the god object of Zilles and Salisbury, 1995, on the exact relief).
class ReferencePen {
 public:
  ReferencePen(const Reference& truth, double radius, double stiffness, double friction)
      : truth_(truth), radius_(radius), stiffness_(stiffness), friction_(friction) {}

  // Moves the tip after the hand (both are the tip sphere's lowest point); returns the force on the hand, N.
  Vec3 follow(const Vec3& hand);
  const Vec3& tip() const { return tip_; }
  bool touches() const { return touches_; }

 private:
  const Reference& truth_;
  double radius_, stiffness_, friction_;
  Vec3 tip_ = Vec3::Zero();
  bool touches_ = false;
};

}  // namespace intaglio::evaluate
