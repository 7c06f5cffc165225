// What every query begins with: the body's pose in the placement's frame, the margin within bounds, and what
// is wrong with the question. Internal to contact/.
#pragma once

#include "intaglio/contact/candidates.h"
#include "intaglio/contact/shape.h"
#include "intaglio/surface/surface.h"

namespace intaglio::contact {

// A pose as rotation matrix and position, in the local frame of a placement.
struct Frame {
  Mat3 axes;
  Vec3 origin;

  Vec3 operator()(const Vec3& body) const { return origin + axes * body; }
  Vec3 back(const Vec3& local) const { return axes.transpose() * (local - origin); }
  Frame operator()(const Pose& child) const {
    return {axes * child.orientation.normalized().toRotationMatrix(), (*this)(child.position)};
  }
};

struct Question {
  const surface::Surface& surface;
  Frame frame;
  double reach;    // bounding radius of the body
  double margin;   // within bounds
  unsigned wrong;  // status bits
  bool hopeless;   // there is nothing to look for

  Question(const surface::Surface& asked, const Shape& shape, const Pose& pose, double wanted_margin);
};

// Whether the position is finite and the orientation a rotation, give or take its length.
bool is_rigid(const Pose& pose);

// Whether the sizes of a shape are finite and above zero; of a compound, whether those of some child are.
bool has_size(const Shape& shape);

// Calls visit(shape, frame, child index) for every shape that is not a compound and has a size; depth of
// nesting is bounded. Returns status bits.
template <class Visit>
unsigned for_each_part(const Shape& shape, const Frame& frame, const Visit& visit, int child = 0,
                       int nesting = 0);

template <class Visit>
unsigned for_each_part(const Shape& shape, const Frame& frame, const Visit& visit, int child, int nesting) {
  if (!has_size(shape)) return status::no_size;
  const auto* compound = std::get_if<Compound>(&shape);
  if (compound == nullptr) {
    visit(shape, frame, child);
    return status::ok;
  }
  if (nesting >= 8) return status::limit;
  unsigned wrong = status::ok;
  int index = child;
  for (const CompoundChild& part : *compound->children) {
    wrong |= is_rigid(part.pose) ? for_each_part(part.shape, frame(part.pose), visit, index, nesting + 1)
                                 : status::bad_pose;
    ++index;
  }
  return wrong;
}

}  // namespace intaglio::contact
