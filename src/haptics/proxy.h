// What a tip can press into: a signed depth and its gradient at any point of a body's own frame.
//
// The depth need not be a distance: it is positive inside, zero on the surface, and falls outwards. For a
// texture it is h - z, the height of the relief over the base less the point's own, with the relief averaged
// over the diameter of the tip; where a side or the underside of the slab is nearer, the distance to that. A
// single-valued function of position, so that an energy made of it is one too. Real-time; any thread.
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
  Vec3 gradient = -Vec3::UnitY();  // of the depth: into the body
};

class Solid {
 public:
  virtual ~Solid() = default;
  virtual Penetration at(const Vec3& p) const = 0;
};

struct SolidOptions {
  Representation representation = Representation::relief;
  double footprint = 0.002;                                    // m, over which a tip averages the relief
  double thickness = std::numeric_limits<double>::infinity();  // m, of the slab, from the base plane down
};

// The relief that a tip feels. `flat`: none. `relief`: the height. `normal`: the height about its mean, so
// that the tip stays at the base plane on average while slopes are those of the texture.
class FeltRelief {
 public:
  FeltRelief(std::shared_ptr<const surface::Surface> surface, const SolidOptions& options);

  surface::Smooth at(const Vec2& uv) const {
    if (flat_) return {0, Vec2::Zero()};
    surface::Smooth s = surface_->smooth(uv, footprint_);
    s.height -= offset_;
    return s;
  }
  // The felt height is nowhere above this, metres.
  double top() const { return top_; }
  double bottom() const { return -surface_->max_depth() - offset_; }
  const surface::Surface& surface() const { return *surface_; }

 private:
  std::shared_ptr<const surface::Surface> surface_;
  double footprint_, offset_ = 0, top_ = 0;
  bool flat_;
};

// A slab with a textured top, where the surface's own placement says: body frame = world of that placement.
// About 0.1 us where the tip is near the relief.
class TexturedSlab : public Solid {
 public:
  TexturedSlab(std::shared_ptr<const surface::Surface> surface, const SolidOptions& options);
  Penetration at(const Vec3& p) const override;
  const FeltRelief& relief() const { return relief_; }

 private:
  FeltRelief relief_;
  double thickness_;
};

// A closed or open mesh whose skin is textured. The depth's gradient takes the base as flat around its
// nearest point, which is exact on the base and off by height / radius of curvature above it: good enough for
// a step of the proxy, whose energy is made of depths alone. About 3 us. `depth` tells the texture's tallest
// relief in metres of the mesh, `reach` how far from the base a tip may be and still be told.
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
