// The base plane as a relief. Internal to contact/.
#pragma once

#include "intaglio/contact/relief.h"

namespace intaglio::contact {

// Contacts with the rectangle z = 0, their normals n_g; n_s is that of the map.
ContactSet plane_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                          double margin);

}  // namespace intaglio::contact
