// The body's lower side as a height over the surface: what §1.3.1 rasterises. Internal to contact/.
#pragma once

#include "intaglio/contact/question.h"

namespace intaglio::contact {

// Of one shape that is not a compound.
class LowerHeight {
 public:
  LowerHeight(const Shape& shape, const Frame& frame) : shape_(shape), frame_(frame) {}

  // z of the lowest point of the body over local (x, y), metres; infinite beside the body.
  double at(double x, double y) const;

 private:
  const Shape& shape_;
  const Frame& frame_;
};

}  // namespace intaglio::contact
