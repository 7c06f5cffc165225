// The points of a body that can touch a plane below it: what the flat and the normal map's methods ask.
// Internal to contact/.
#pragma once

#include <array>
#include <cstddef>

#include "intaglio/contact/question.h"

namespace intaglio::contact {

struct Foot {
  Vec3 point;     // of the body, local frame
  Vec3 core;      // what a round body turns about there: the centre of its curvature
  double radius;  // of that curvature; 0 at a corner
  int index;      // which one of the part, the same while the body turns
};

// Calls visit(foot, child) for every point that is lowest among its neighbours, or nearly: corners of boxes,
// hulls and meshes, ends of capsules, of cylinders four points of each rim. Returns status bits.
template <class Visit>
unsigned for_each_foot(const Shape& shape, const Frame& frame, const Visit& visit);

namespace feet {

template <class Visit>
void of(const Sphere& s, const Frame& frame, const Visit& visit) {
  visit(Foot{frame.origin - s.radius * Vec3::UnitZ(), frame.origin, s.radius, 0});
}

template <class Visit>
void of(const Capsule& s, const Frame& frame, const Visit& visit) {
  for (const int end : {0, 1}) {
    const Vec3 centre = frame({0, end == 0 ? -s.half_height : s.half_height, 0});
    visit(Foot{centre - s.radius * Vec3::UnitZ(), centre, s.radius, end});
  }
}

template <class Visit>
void of(const Box& s, const Frame& frame, const Visit& visit) {
  for (int k = 0; k < 8; ++k) {
    const Vec3 point = frame(Vec3(k & 1 ? s.half.x() : -s.half.x(), k & 2 ? s.half.y() : -s.half.y(),
                                  k & 4 ? s.half.z() : -s.half.z()));
    visit(Foot{point, point, 0, k});
  }
}

// The lowest point of each rim and those a quarter and a half round from it: a standing cylinder rests on
// them.
template <class Visit>
void of(const Cylinder& s, const Frame& frame, const Visit& visit) {
  const Vec3 axis = frame.axes.col(1);
  Vec3 down = -Vec3::UnitZ() + axis.z() * axis;
  // Upright, none is lowest: those of the body's own axes.
  down = down.norm() > 1e-6 ? Vec3(down.normalized()) : Vec3(frame.axes.col(0));
  const Vec3 aside = axis.cross(down);
  for (int k = 0; k < 8; ++k) {
    const Vec3 out = (k & 2 ? aside : down) * (k & 4 ? -s.radius : s.radius);
    const Vec3 point = frame.origin + (k & 1 ? s.half_height : -s.half_height) * axis + out;
    visit(Foot{point, point, 0, k});
  }
}

template <class Visit>
void of(const std::shared_ptr<const Polyhedron>& form, const Frame& frame, const Visit& visit) {
  int index = 0;
  for (const Vec3& v : form->vertices) {
    const Vec3 point = frame(v);
    visit(Foot{point, point, 0, index++});
  }
}

template <class Visit>
void of(const ConvexHull& s, const Frame& frame, const Visit& visit) {
  of(s.form, frame, visit);
}
template <class Visit>
void of(const Mesh& s, const Frame& frame, const Visit& visit) {
  of(s.form, frame, visit);
}
template <class Visit>
void of(const Compound&, const Frame&, const Visit&) {}

}  // namespace feet

template <class Visit>
unsigned for_each_foot(const Shape& shape, const Frame& frame, const Visit& visit) {
  return for_each_part(shape, frame, [&](const Shape& part, const Frame& at, int child) {
    std::visit([&](const auto& s) { feet::of(s, at, [&](const Foot& foot) { visit(foot, child); }); }, part);
  });
}

}  // namespace intaglio::contact
