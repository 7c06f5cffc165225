// The solid that a surface becomes when it is given a thickness: all that lies within half of it, straight
// out from the surface; at a rim it ends square.
#pragma once

#include <set>

#include "intaglio/sound/fem/surface_query.h"

namespace intaglio::sound {

class ThickShell {
 public:
  // Both must outlive it; body.thickness > 0.
  ThickShell(const BodySurface& body, const SurfaceQuery& surface);

  bool holds(const Vec3& p) const;

 private:
  const BodySurface& body_;
  const SurfaceQuery& surface_;
  std::set<std::pair<int, int>> rim_;  // edges of one triangle
};

}  // namespace intaglio::sound
