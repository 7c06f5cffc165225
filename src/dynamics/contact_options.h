// How contacts with a texture are found: options shared by World, which does without Bullet's headers, and
// TexturedShape.
#pragma once

#include "intaglio/representation.h"

namespace intaglio::dynamics {

using intaglio::ContactMethod;
using intaglio::NormalMethod;

struct ContactOptions {
  Representation representation = Representation::relief;
  ContactMethod method = ContactMethod::closest;
  NormalMethod normal_method = NormalMethod::implied;
};

}  // namespace intaglio::dynamics
