// How low and how high a body reaches. Internal to contact/.
#pragma once

#include "intaglio/contact/question.h"

namespace intaglio::contact {

struct Extent {
  double low, high;  // z, local frame, metres
};

// Exact; of a compound that of all its parts.
Extent extent_of(const Shape& shape, const Frame& frame);

}  // namespace intaglio::contact
