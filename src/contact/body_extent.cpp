#include "contact/body_extent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/portable_math.h"

namespace intaglio::contact {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Half the vertical extent of a shape symmetric about its origin; `up` is vertical in its frame.
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

// A vertical line in the body frame: from + t * up, where t is z in the local frame.
struct VerticalLine {
  Vec3 from, up;
};

// Interval of a line inside a convex body, in its t; empty when `enter` exceeds `leave`.
struct Interval {
  double enter = -infinity, leave = infinity;

  void clear() {
    enter = infinity;
    leave = -infinity;
  }
  // Clips to the inner side of the plane normal . x = offset.
  void clip(const VerticalLine& line, const Vec3& normal, double offset) {
    const double along = normal.dot(line.up), height = normal.dot(line.from) - offset;
    if (std::abs(along) < 1e-15) {
      if (height > 0) clear();
    } else if (along < 0) {
      enter = std::max(enter, -height / along);
    } else {
      leave = std::min(leave, -height / along);
    }
  }
  // Clips to a t^2 + 2 b t + c <= 0.
  void clip_quadratic(double a, double b, double c) {
    const double root2 = b * b - a * c;
    if (a < 1e-15) {
      if (c > 0) clear();
    } else if (root2 < 0) {
      clear();
    } else {
      const double root = std::sqrt(root2);
      enter = std::max(enter, (-b - root) / a);
      leave = std::min(leave, (-b + root) / a);
    }
  }
  double entry() const { return enter <= leave ? enter : infinity; }
};

double enter_sphere(const VerticalLine& line, const Vec3& centre, double radius) {
  const Vec3 from = line.from - centre;
  Interval s;
  s.clip_quadratic(1, from.dot(line.up), from.squaredNorm() - radius * radius);
  return s.entry();
}

double enter_cylinder(const VerticalLine& line, double radius, double half_height) {
  const Vec3 &f = line.from, &u = line.up;
  Interval s;
  s.clip_quadratic(u.x() * u.x() + u.z() * u.z(), f.x() * u.x() + f.z() * u.z(),
                   f.x() * f.x() + f.z() * f.z() - radius * radius);
  s.clip(line, Vec3::UnitY(), half_height);
  s.clip(line, -Vec3::UnitY(), half_height);
  return s.entry();
}

double enter_mesh(const VerticalLine& line, const Polyhedron& form) {
  double lowest = infinity;
  for (const Polyhedron::Face& face : form.faces) {
    const double along = face.normal.dot(line.up);
    if (along >= -1e-15) continue;
    const double t = (face.offset - face.normal.dot(line.from)) / along;
    if (t >= lowest) continue;
    const Vec3 at = line.from + t * line.up;
    bool inside = true;
    for (int k = 0; k < face.count && inside; ++k) {
      const Vec3& a = form.vertices[std::size_t(form.loop[std::size_t(face.first + k)])];
      const Vec3& b = form.vertices[std::size_t(form.loop[std::size_t(face.first + (k + 1) % face.count)])];
      inside = (b - a).cross(at - a).dot(face.normal) >= 0;
    }
    if (inside) lowest = t;
  }
  return lowest;
}

struct EntryHeight {
  const VerticalLine& line;

  double operator()(const Sphere& s) const { return enter_sphere(line, Vec3::Zero(), s.radius); }
  double operator()(const Capsule& s) const {
    const Vec3 end(0, s.half_height, 0);
    return std::min(enter_cylinder(line, s.radius, s.half_height),
                    std::min(enter_sphere(line, end, s.radius), enter_sphere(line, -end, s.radius)));
  }
  double operator()(const Box& s) const {
    Interval interval;
    for (int k = 0; k < 3; ++k) {
      interval.clip(line, Vec3::Unit(k), s.half[k]);
      interval.clip(line, -Vec3::Unit(k), s.half[k]);
    }
    return interval.entry();
  }
  double operator()(const Cylinder& s) const { return enter_cylinder(line, s.radius, s.half_height); }
  double operator()(const ConvexHull& s) const {
    Interval interval;
    for (const Polyhedron::Face& face : s.form->faces) interval.clip(line, face.normal, face.offset);
    return interval.entry();
  }
  double operator()(const Mesh& s) const { return enter_mesh(line, *s.form); }
  double operator()(const Compound&) const { return infinity; }
};

}  // namespace

Extent vertical_extent(const Shape& shape, const Frame& frame) {
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

double Underside::at(double x, double y) const {
  const VerticalLine line{frame_.back({x, y, 0}), frame_.axes.transpose() * Vec3::UnitZ()};
  return std::visit(EntryHeight{line}, shape_);
}

}  // namespace intaglio::contact
