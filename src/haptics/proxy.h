// The proxy: the point on the surface to which a spring ties the tip, and the bodies it can touch.
#pragma once

#include <limits>
#include <memory>

#include "intaglio/event.h"
#include "intaglio/representation.h"
#include "mesh/mesh_placement.h"
#include "surface/surface.h"

namespace intaglio::haptics {

struct Penetration {
  double depth = -1;               // m, positive inside
  Vec3 gradient = -Vec3::UnitY();  // of the depth: points into the body
};

// A body as a signed depth field: the depth and its gradient at any point of the body's own frame.
//
// The depth need not be a distance: it is positive inside, zero on the surface, and falls outwards. For a
// texture it is h - z: the height h of the relief, averaged over the diameter of the tip, minus the height z
// of the point, both above the base. Where a side or the underside of a slab is nearer, it is the distance to
// that. It must be a single-valued function of position, and continuous where it is positive: only then is
// the energy made of it a potential. Real-time; any thread.
class Solid {
 public:
  virtual ~Solid() = default;
  virtual Penetration at(const Vec3& p) const = 0;
};

struct SolidOptions {
  Representation representation = Representation::relief;
  double footprint = 0.002;  // m, diameter over which the relief is averaged
  double thickness = std::numeric_limits<double>::infinity();  // m, of the slab, from the base plane down
};

// The relief as a tip feels it. `flat`: none. `relief`: the height. `normal`: the height minus its mean, so
// that the tip stays at the base plane on average and feels the slopes of the texture.
class FeltRelief {
 public:
  FeltRelief(std::shared_ptr<const surface::Surface> surface, const SolidOptions& options);

  surface::SmoothHeight at(const Vec2& uv) const {
    if (flat_) return {0, Vec2::Zero()};
    surface::SmoothHeight s = surface_->smooth(uv, footprint_);
    s.height -= offset_;
    return s;
  }
  // Upper bound of the felt height, metres.
  double top() const { return top_; }
  const surface::Surface& surface() const { return *surface_; }

 private:
  std::shared_ptr<const surface::Surface> surface_;
  double footprint_, offset_ = 0, top_ = 0;
  bool flat_;
};

// A slab with a textured top. Its frame is the world in which the surface is placed. A query takes about 0.1
// us near the relief.
class TexturedSlab : public Solid {
 public:
  TexturedSlab(std::shared_ptr<const surface::Surface> surface, const SolidOptions& options);
  Penetration at(const Vec3& p) const override;
  const FeltRelief& relief() const { return relief_; }

 private:
  FeltRelief relief_;
  double thickness_;
};

// A closed or open mesh with a textured skin. The gradient takes the base as flat around its nearest point,
// which is exact on the base and off by height / radius of curvature above it: good enough for a step of the
// proxy, whose energy depends on depths only. `reach` is the largest distance from the base at which the
// depth is found; a relief that stands higher is always reached. About 3 us.
class TexturedMesh : public Solid {
 public:
  TexturedMesh(std::shared_ptr<const surface::Surface> surface, surface::MeshPlacement mesh, double reach,
               const SolidOptions& options);
  Penetration at(const Vec3& p) const override;

 private:
  FeltRelief relief_;
  surface::MeshPlacement mesh_;
  double reach_;
};

// The springs of coupling and surface, in series.
struct ContactSprings {
  double coupling = 1000;  // N/m, K_c: the upper bound of the stiffness felt
  double surface = 4000;   // N/m, K_s

  // Springs that feel like `stiffness` on flat ground and at most `max_ratio` times as stiff anywhere.
  static ContactSprings for_felt_stiffness(double stiffness, double max_ratio = 1.25) {
    return {max_ratio * stiffness, max_ratio / (max_ratio - 1) * stiffness};
  }
};

// Where the tip would be if the surface could not be pressed in, with friction; and the force that pulls the
// hand there.
//
// Energy. A spring (the virtual coupling, K_c) ties the device's tip x to the proxy y; the surface pushes the
// proxy out by the potential U(y) = 1/2 K_s depth(y)^2 (0 outside), depth = h - z. Together they store
//
//     W(x, y) = 1/2 K_c |x - y|^2 + U(y),     force on the hand = -dW/dx = K_c (y - x).
//
// A tick first moves x with y held, so that the hand's work is exactly the change of W; then it moves y
// towards the minimum of W for that x, and only if W does not grow. W therefore never exceeds the work that
// the hand has put in: no closed loop yields energy, whatever the texture and whether or not the descent has
// converged. (What a held force adds between two ticks is the passivity controller's concern.)
//
// Potential. While y follows one minimum, converged and without friction, W is a function of x alone,
//
//     V(x) = min over y of W(x, y)     (the Moreau envelope of U),
//
// and the force is -grad V: conservative. Where that minimum ends, y jumps to a lower one, as a tip does that
// snaps over an edge, and W falls. V is felt with stiffness K_c K_s / (K_c + K_s) on flat ground and never
// with more than K_c, however steep the relief; the plain potential U(x) at the tip itself has
// K (1 + slope^2) and buzzes in grooves.
//
// Friction is a y that lags: its tangential step ends where the remaining pull equals mu times the load, the
// normal force's component along the base normal, so that stick and slip need no states. With the normal
// force itself in place of the load, a wall of the texture whose slope times mu exceeds 1 would hold the tip
// against any pull along the base.
//
// Frame: the body's own; SI. Real-time: at most 6 samples of the solid per move, mostly 1; one thread.
// Sources: Zilles and Salisbury 1995 (god object), Ruspini et al. 1997 and Hayward and Armstrong 2000
// (friction), Colgate et al. 1995 (virtual coupling); the step is Gauss-Newton.
class Proxy {
 public:
  // Result of a move, in the body's frame.
  struct Contact {
    bool touching = false;
    Vec3 force = Vec3::Zero();    // N, on the hand
    Vec3 normal = Vec3::UnitY();  // unit, out of the surface at the proxy
    double energy = 0;            // J, W: the energy that the hand can get back
    int samples = 0;              // of the solid
  };

  // Moves the proxy towards the tip at x. `friction` is Coulomb's coefficient.
  Contact move(const Solid& solid, const Vec3& x, const ContactSprings& stiffness, double friction);

  const Vec3& position() const { return y_; }
  // The next move starts at the tip, or on the surface next to it if the tip is inside.
  void reset() { started_ = false; }

 private:
  void start(const Solid& solid, const Vec3& x);
  Vec3 step(const Vec3& x, const ContactSprings& k, double friction) const;
  bool descend(const Solid& solid, const Vec3& x, const ContactSprings& k, const Vec3& step, int& samples);
  double energy(const Vec3& x, const ContactSprings& k, const Vec3& y, double depth) const;

  Vec3 y_ = Vec3::Zero();
  Penetration at_;  // at y_
  bool started_ = false;
};

}  // namespace intaglio::haptics
