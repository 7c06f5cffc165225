// How contacts with a texture are found: what both the world and the Bullet shape can be told.
#pragma once

#include "intaglio/event.h"
#include "intaglio/representation.h"

namespace intaglio::dynamics {

// With a relief (contact/).
enum class ContactMethod {
  closest,      // ours: closest features, true penetration
  directional,  // the paper's: height maps compared along n_g, §1.3.1
};

// With a normal map.
enum class NormalMethod {
  implied,  // ours: contact with the relief that the normals imply (surface/implied.h)
  literal,  // the paper's: the flat contact with its normal replaced, Eq. 1.1 and 1.2, spheres only
};

struct ContactOptions {
  Representation representation = Representation::relief;
  ContactMethod method = ContactMethod::closest;
  NormalMethod normal_method = NormalMethod::implied;
};

}  // namespace intaglio::dynamics
