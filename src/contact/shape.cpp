#include "contact/shape.h"

#include <algorithm>
#include <numbers>

#include "core/portable_math.h"

namespace intaglio {

namespace {

struct BoundingRadius {
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Capsule& s) const { return s.half_height + s.radius; }
  double operator()(const Box& s) const { return s.half.norm(); }
  double operator()(const Cylinder& s) const { return elementary::hypot(s.radius, s.half_height); }
  double operator()(const ConvexHull& s) const { return s.form ? s.form->radius : 0; }
  double operator()(const Mesh& s) const { return s.form ? s.form->radius : 0; }
  double operator()(const Compound& s) const {
    double radius = 0;
    if (s.children)
      for (const CompoundChild& c : *s.children)
        radius = std::max(radius, c.pose.position.norm() + bounding_radius(c.shape));
    return radius;
  }
};

}  // namespace

double bounding_radius(const Shape& shape) {
  return std::visit(BoundingRadius{}, shape);
}

namespace {

constexpr double pi = std::numbers::pi;

// Inertia of a point mass at r, per kilogram.
Mat3 of_point(const Vec3& r) {
  return r.squaredNorm() * Mat3::Identity() - r * r.transpose();
}

MassProperties round_the_y_axis(double volume, double across, double along) {
  return {volume, Vec3::Zero(), Vec3(across, along, across).asDiagonal()};
}

MassProperties of_tetrahedra(const Polyhedron& form) {
  contact::EnclosedMass sum;
  for (const Polyhedron::Face& face : form.faces) {
    const auto corner = [&](int k) -> const Vec3& {
      return form.vertices[std::size_t(form.loop[std::size_t(face.first + k)])];
    };
    for (int k = 1; k + 1 < face.count; ++k) sum.add(corner(0), corner(k), corner(k + 1));
  }
  return sum.properties();
}

struct Properties {
  MassProperties operator()(const Sphere& s) const {
    const double volume = 4.0 / 3 * pi * s.radius * s.radius * s.radius;
    const double i = 0.4 * volume * s.radius * s.radius;
    return round_the_y_axis(volume, i, i);
  }
  MassProperties operator()(const Capsule& s) const {
    const double r = s.radius, h = s.half_height;
    const double tube = 2 * pi * r * r * h, ball = 4.0 / 3 * pi * r * r * r;
    const double along = tube * r * r / 2 + ball * 0.4 * r * r;
    // A half ball's centre of mass is 3/8 r from its flat side.
    const double across = tube * (r * r / 4 + h * h / 3) + ball * (0.4 * r * r + h * h + 0.75 * h * r);
    return round_the_y_axis(tube + ball, across, along);
  }
  MassProperties operator()(const Box& s) const {
    const double volume = 8 * s.half.prod();
    const Vec3 square = s.half.cwiseAbs2() * volume / 3;
    return {volume, Vec3::Zero(), Vec3(Vec3::Constant(square.sum()) - square).asDiagonal()};
  }
  MassProperties operator()(const Cylinder& s) const {
    const double r = s.radius, h = s.half_height, volume = 2 * pi * r * r * h;
    return round_the_y_axis(volume, volume * (r * r / 4 + h * h / 3), volume * r * r / 2);
  }
  MassProperties operator()(const ConvexHull& s) const {
    return s.form ? of_tetrahedra(*s.form) : MassProperties{};
  }
  MassProperties operator()(const Mesh& s) const {
    return s.form ? of_tetrahedra(*s.form) : MassProperties{};
  }
  MassProperties operator()(const Compound& s) const {
    MassProperties sum;
    if (!s.children) return sum;
    for (const CompoundChild& child : *s.children) {
      const MassProperties part = mass_properties(child.shape);
      sum.volume += part.volume;
      sum.centre += part.volume * child.pose.to_world(part.centre);
    }
    if (sum.volume > 0) sum.centre /= sum.volume;
    for (const CompoundChild& child : *s.children) {
      const MassProperties part = mass_properties(child.shape);
      const Mat3 turn = child.pose.orientation.toRotationMatrix();
      sum.inertia += turn * part.inertia * turn.transpose() +
                     part.volume * of_point(child.pose.to_world(part.centre) - sum.centre);
    }
    return sum;
  }
};

}  // namespace

MassProperties mass_properties(const Shape& shape) {
  return std::visit(Properties{}, shape);
}

Result<ConvexHull> make_hull(std::span<const Vec3> points) {
  return contact::convex_hull(points).map([](auto form) { return ConvexHull{std::move(form)}; });
}

Result<Mesh> make_mesh(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles) {
  return contact::closed_mesh(vertices, triangles).map([](auto form) { return Mesh{std::move(form)}; });
}

namespace contact {

void EnclosedMass::add(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 sum = a + b + c;
  const double v = a.dot(b.cross(c)) / 6;
  volume_ += v;
  first_ += v / 4 * sum;
  second_ += v / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
}

MassProperties EnclosedMass::properties() const {
  const Vec3 centre = first_ / volume_;
  const Mat3 about = second_ - volume_ * centre * centre.transpose();
  return {volume_, centre, about.trace() * Mat3::Identity() - about};
}

}  // namespace contact

}  // namespace intaglio
