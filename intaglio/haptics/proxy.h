// The proxy: where the tip would be if the surface could not be pressed in, with friction; and the force that
// pulls the hand to it.
//
// A spring (the virtual coupling, K_c) ties the device's tip x to the proxy y; the surface pushes the proxy
// out with the potential U(y) = 1/2 K_s depth(y)^2, depth = h - z. Together they store
//
//     W(x, y) = 1/2 K_c |x - y|^2 + U(y),     force on the hand = -dW/dx = K_c (y - x).
//
// Every tick moves y towards the minimum of W for the given x, and only if W does not grow. So the hand's
// work is -dW less what y's descent has dissipated: no closed loop gives energy, whether or not the descent
// has converged, whatever the texture. Converged and without friction, the force is the gradient of a
// single-valued potential, the Moreau envelope of U. Friction is a y that stays behind: its tangential step
// ends where the rest of the pull is mu times the load, the normal force's part along the base's normal
// (stick and slip by themselves). Of the load and not of the normal force, so that a steep wall of a texture
// does not lock the tip for ever: with mu times the slope over 1 no pull along the base would get it over.
// The stiffness felt is K_c K_s / (K_c + K_s) on flat ground and never more than K_c, however steep the
// relief: potentials taken at the tip itself have K (1 + slope^2).
//
// Frame: the body's own; SI. Real-time: at most 6 samples of the solid a move, mostly 1; one thread. Sources:
// Zilles and Salisbury 1995 (god object), Ruspini et al. 1997 and Hayward and Armstrong 2000 (friction),
// Colgate et al. 1995 (virtual coupling); the step is Gauss-Newton.
#pragma once

#include "intaglio/haptics/solid.h"

namespace intaglio::haptics {

// The two springs in series.
struct ContactStiffness {
  double coupling = 1000;  // N/m, K_c: the most that is felt anywhere
  double surface = 4000;   // N/m, K_s

  // Felt on flat ground is `stiffness`; anywhere at most `most_over` of it.
  static ContactStiffness felt(double stiffness, double most_over = 1.25) {
    return {most_over * stiffness, most_over / (most_over - 1) * stiffness};
  }
};

class Proxy {
 public:
  // What a move found, all in the body's frame.
  struct Contact {
    bool touching = false;
    Vec3 force = Vec3::Zero();    // N, on the hand
    Vec3 normal = Vec3::UnitY();  // unit, out of the surface at the proxy
    double energy = 0;            // J, W: what the hand can get back
    int samples = 0;              // of the solid
  };

  // Moves the proxy after the tip at x. `friction` is Coulomb's.
  Contact move(const Solid& solid, const Vec3& x, const ContactStiffness& stiffness, double friction);

  const Vec3& position() const { return y_; }
  // The next move starts at the tip, or straight above it when the tip is inside.
  void forget() { started_ = false; }

 private:
  void start(const Solid& solid, const Vec3& x);
  Vec3 step(const Vec3& x, const ContactStiffness& k, double friction) const;
  bool descend(const Solid& solid, const Vec3& x, const ContactStiffness& k, const Vec3& step, int& samples);
  double energy(const Vec3& x, const ContactStiffness& k, const Vec3& y, double depth) const;

  Vec3 y_ = Vec3::Zero();
  Penetration at_;  // at y_
  bool started_ = false;
};

}  // namespace intaglio::haptics
