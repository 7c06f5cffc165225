#include "contact/body_extent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/portable_math.h"

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

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// A vertical line in the body frame: from + t * up, t = z of the local frame.
struct Line {
  Vec3 from, up;
};

// What a line passes inside of a convex body.
struct Stretch {
  double enter = -infinity, leave = infinity;

  void miss() {
    enter = infinity;
    leave = -infinity;
  }
  // Keeps what is on the inner side of the plane normal . x = offset.
  void cut(const Line& line, const Vec3& normal, double offset) {
    const double along = normal.dot(line.up), away = normal.dot(line.from) - offset;
    if (std::abs(along) < 1e-15) {
      if (away > 0) miss();
    } else if (along < 0) {
      enter = std::max(enter, -away / along);
    } else {
      leave = std::min(leave, -away / along);
    }
  }
  // Keeps what is inside a x^2 + 2 b x + c <= 0.
  void cut_quadratic(double a, double b, double c) {
    const double root2 = b * b - a * c;
    if (a < 1e-15) {
      if (c > 0) miss();
    } else if (root2 < 0) {
      miss();
    } else {
      const double root = std::sqrt(root2);
      enter = std::max(enter, (-b - root) / a);
      leave = std::min(leave, (-b + root) / a);
    }
  }
  double entry() const { return enter <= leave ? enter : infinity; }
};

double of_ball(const Line& line, const Vec3& centre, double radius) {
  const Vec3 from = line.from - centre;
  Stretch s;
  s.cut_quadratic(1, from.dot(line.up), from.squaredNorm() - radius * radius);
  return s.entry();
}

double of_tube(const Line& line, double radius, double half_height) {
  const Vec3 &f = line.from, &u = line.up;
  Stretch s;
  s.cut_quadratic(u.x() * u.x() + u.z() * u.z(), f.x() * u.x() + f.z() * u.z(),
                  f.x() * f.x() + f.z() * f.z() - radius * radius);
  s.cut(line, Vec3::UnitY(), half_height);
  s.cut(line, -Vec3::UnitY(), half_height);
  return s.entry();
}

double of_triangles(const Line& line, const Polyhedron& form) {
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

struct Entry {
  const Line& line;

  double operator()(const Sphere& s) const { return of_ball(line, Vec3::Zero(), s.radius); }
  double operator()(const Capsule& s) const {
    const Vec3 end(0, s.half_height, 0);
    return std::min(of_tube(line, s.radius, s.half_height),
                    std::min(of_ball(line, end, s.radius), of_ball(line, -end, s.radius)));
  }
  double operator()(const Box& s) const {
    Stretch stretch;
    for (int k = 0; k < 3; ++k) {
      stretch.cut(line, Vec3::Unit(k), s.half[k]);
      stretch.cut(line, -Vec3::Unit(k), s.half[k]);
    }
    return stretch.entry();
  }
  double operator()(const Cylinder& s) const { return of_tube(line, s.radius, s.half_height); }
  double operator()(const ConvexHull& s) const {
    Stretch stretch;
    for (const Polyhedron::Face& face : s.form->faces) stretch.cut(line, face.normal, face.offset);
    return stretch.entry();
  }
  double operator()(const Mesh& s) const { return of_triangles(line, *s.form); }
  double operator()(const Compound&) const { return infinity; }
};

}  // namespace

double LowerHeight::at(double x, double y) const {
  const Line line{frame_.back({x, y, 0}), frame_.axes.transpose() * Vec3::UnitZ()};
  return std::visit(Entry{line}, shape_);
}

}  // namespace intaglio::contact
