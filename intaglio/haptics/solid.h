// What a tip can press into: a signed depth and its gradient at any point of a body's own frame.
//
// The depth need not be a distance: it is positive inside, zero on the surface, and falls outwards. For a
// texture it is h - z, the height of the relief over the base less the point's own, with the relief averaged
// over the diameter of the tip; where a side or the underside of the slab is nearer, the distance to that. A
// single-valued function of position, so that an energy made of it is one too. Real-time; any thread.
#pragma once

#include <limits>
#include <memory>

#include "intaglio/core/representation.h"
#include "intaglio/surface/mesh/mesh_placement.h"
#include "intaglio/surface/surface.h"

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

}  // namespace intaglio::haptics
