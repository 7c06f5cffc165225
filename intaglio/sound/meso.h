// Meso-level sound: the bumps a normal map shows, met by a body that slides or rolls over them (§1.2.5.1).
//
// Pure, any thread, no allocation. While a body follows the map its momentum across the coarse face is p_n;
// whenever its contact point comes to a new texel, the difference is an impulse.
#pragma once

#include <span>

#include "intaglio/surface/surface.h"

namespace intaglio::sound {

// n_g . n_s is taken to be at least this: the momentum on a slope of more than about 84 degrees stays finite.
inline constexpr double least_normal_cosine = 0.1;

// p_n = m (-v_t . n_s / n_g . n_s) n_g, kg m/s: the momentum across the face of a body of `mass` (kg) that
// moves with v_t (m/s) along a face of unit normal n_g where the texel's unit normal is n_s.
// Eq. 1.4, Sterling & Lin 2016, §1.2.5.1
Vec3 normal_momentum(double mass, const Vec3& v_t, const Vec3& n_g, const Vec3& n_s);

struct MesoImpulse {
  double fraction = 0;  // when within the step: 0 start, 1 end
  double impulse = 0;   // N s, along n_g: what parts the bodies is positive
};

struct MesoWalk {
  std::size_t count = 0;    // impulses written
  bool is_complete = true;  // false when there were more crossings than room; the rest are left out
};

// Visits each texel that the straight path from uv0 to uv1 crosses, in order, and writes the impulse of each
// crossing to `out`. `sweep`: v_t along u and v, m/s; wherever the surface lies and whatever it is bent
// round, its own frame is all that counts. The path may leave 0..1; the surface wraps or clamps. Cost: two
// texels a crossing. Source of the traversal: Amanatides & Woo, "A fast voxel traversal algorithm for ray
// tracing", 1987.
MesoWalk walk_texels(const surface::Surface& surface, const Vec2& uv0, const Vec2& uv1, double mass,
                     const Vec2& sweep, std::span<MesoImpulse> out);

}  // namespace intaglio::sound
