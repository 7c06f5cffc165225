#include "intaglio/contact/extent_of.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "intaglio/core/elementary.h"

namespace intaglio::contact {

namespace {

// Half of the extent of what is symmetric about its origin, with `up` the vertical in its frame.
struct HalfExtent {
  const Vec3& up;

  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Capsule& s) const { return s.radius + s.half_height * std::abs(up.y()); }
  double operator()(const Box& s) const { return s.half.dot(up.cwiseAbs()); }
  double operator()(const Cylinder& s) const {
    return s.radius * elementary::hypot(up.x(), up.z()) + s.half_height * std::abs(up.y());
  }
  double operator()(const ConvexHull&) const { return 0; }
  double operator()(const Mesh&) const { return 0; }
  double operator()(const Compound&) const { return 0; }
};

const Polyhedron* form_of(const Shape& shape) {
  if (const auto* hull = std::get_if<ConvexHull>(&shape)) return hull->form.get();
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return mesh->form.get();
  return nullptr;
}

}  // namespace

Extent extent_of(const Shape& shape, const Frame& frame) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Extent all{infinity, -infinity};
  for_each_part(shape, frame, [&](const Shape& part, const Frame& at, int) {
    const Vec3 up = at.axes.transpose() * Vec3::UnitZ();
    const auto add = [&](double from, double to) {
      all = {std::min(all.low, at.origin.z() + from), std::max(all.high, at.origin.z() + to)};
    };
    if (const Polyhedron* form = form_of(part)) {
      for (const Vec3& v : form->vertices) add(up.dot(v), up.dot(v));
    } else {
      const double half = std::visit(HalfExtent{up}, part);
      add(-half, half);
    }
  });
  return all;
}

}  // namespace intaglio::contact
