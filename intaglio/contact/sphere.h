// A sphere against a textured rectangle: three ways to find its contact points. Pure functions, any thread,
// no allocation.
#pragma once

#include "intaglio/contact/contact_point.h"
#include "intaglio/surface/surface.h"

namespace intaglio::contact {

struct Sphere {
  Vec3 centre = Vec3::Zero();  // world, m
  double radius = 0;           // m
};

// Relief, ours: closest features of the bilinear patches. True penetration, right beside vertical walls,
// several contacts (local minima whose directions differ by more than 20 degrees). Points nearer than
// `margin` are reported before they touch.
ContactSet relief_contacts(const surface::Surface& surface, const Sphere& sphere, double margin);

// Relief, the paper's: the sphere is rasterised to a height map at the texture's resolution along n_g and
// compared with the depth texel by texel; the most negative distances are contacts, with the map's normals.
// At most one contact in each quadrant of the sphere's footprint, so that a body in a groove is held from
// both sides.
// §1.3.1, Sterling & Lin 2016
ContactSet directional_contacts(const surface::Surface& surface, const Sphere& sphere, double margin);

// Normal map: one contact with the flat rectangle, its normal replaced by the sampled n_s and its point by q
// (Eq. 1.2). The literal method of §1.2.3: on steep maps the sphere sinks, because nothing pushes along n_g
// (docs/equations.md).
ContactSet normal_map_contacts(const surface::Surface& surface, const Sphere& sphere, double margin);

// The plain rectangle, for comparison.
ContactSet flat_contacts(const surface::Surface& surface, const Sphere& sphere, double margin);

}  // namespace intaglio::contact
