// Contacts of a body with a textured rectangle, by four methods with one signature. Pure functions: any
// thread, no allocation, bounded; results are always finite, and invalid input is reported in
// ContactSet::status.
//
// Points nearer than `margin` (metres, 0 or more) are reported before they touch; it is limited to the
// shorter side of the rectangle. Only points of the surface within the rectangle count.
//
// A contact is a point p of the body and a point q of the relief with opposite outer normals on one line,
// p - q = distance * n, where the gap is a local minimum. Apart, `distance` is the Euclidean distance of
// those points, and that of the first contact is the distance of body and relief. Overlapping, it is minus
// the distance by which these two features must be moved apart along n. Overlapping pairs that are not local
// minima, or too deep, are ignored; pairs.h has the rules. For spheres, capsules and cylinders this holds for
// their core (centre, axis), less the radius.
#pragma once

#include "contact/contact_point.h"
#include "contact/shape.h"
#include "surface/surface.h"

namespace intaglio::contact {

// Relief, exact method: closest features of the bilinear patches, found through the pyramid. True
// penetration, right beside vertical walls; up to six points, the deepest first, then those whose normals
// differ by more than 20 degrees, then those that widen the support.
ContactSet relief_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                           double margin);

// Relief, the paper's method: the body is rasterised to a height map at the texture's resolution along n_g
// and compared with the depth texel by texel; the most negative distances are contacts, with the map's
// normals. At most one contact in each quadrant of the body's footprint, so that a body in a groove is held
// from both sides. Cost: proportional to the texels under the body.
// §1.3.1, Sterling & Lin 2016
ContactSet directional_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                                double margin);

// Normal map: the contacts with the flat rectangle, their normals replaced by the sampled n_s, and for a
// sphere the point by q (Eq. 1.2). The literal method of §1.2.3: on steep maps bodies sink, because nothing
// pushes along n_g (docs/equations.md).
ContactSet normal_map_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                               double margin);

// The plain rectangle, for comparison.
ContactSet flat_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                         double margin);

}  // namespace intaglio::contact
