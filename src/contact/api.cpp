#include "contact/curved_contacts.h"
#include "contact/surface_contacts.h"
#include "intaglio/contact.h"
#include "mesh/api.h"

namespace intaglio {

ContactSet contacts(const Surface& surface, const Shape& body, const Pose& pose, const ContactOptions& options) {
  const surface::Surface& relief = *surface.impl().surface;
  switch (options.representation) {
    case Representation::flat:
      return contact::flat_contacts(relief, body, pose, options.margin);
    case Representation::normal:
      return contact::normal_map_contacts(relief, body, pose, options.margin);
    case Representation::relief:
      break;
  }
  return options.method == ContactMethod::closest
             ? contact::relief_contacts(relief, body, pose, options.margin)
             : contact::directional_contacts(relief, body, pose, options.margin);
}

ContactSet contacts(const CurvedSurface& surface, const Shape& body, const Pose& pose, double margin) {
  return contact::curved_contacts(surface.impl().relief, body, pose, margin);
}

}  // namespace intaglio
