// How contacts with a texture are found: what both the world and the Bullet shape can be told.
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
