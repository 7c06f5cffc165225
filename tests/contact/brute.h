// The distance of a body and a relief without pyramid, features or normals: every patch near the body's
// bounding sphere is cut in four, again and again, as long as the body's distance, a convex function, can be
// less in it than the least found.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contact/shape.h"
#include "surface/surface.h"

namespace intaglio::tests {

struct Distance {
  double value;
  Vec3 gradient;  // unit
};

inline Distance from_point(const Vec3& q, const Vec3& p, double radius = 0) {
  const double d = (q - p).norm();
  return {d - radius, d > 0 ? Vec3((q - p) / d) : Vec3(Vec3::UnitY())};
}

// By the nearest of plane and edges; Ericson, "Real-time collision detection", 2004, has another way.
inline Vec3 nearest_on_triangle(const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const Vec3 foot = q - n * (n.dot(q - a) / n.squaredNorm());
  const auto left = [&](const Vec3& from, const Vec3& to) {
    return (to - from).cross(foot - from).dot(n) >= 0;
  };
  if (left(a, b) && left(b, c) && left(c, a)) return foot;
  Vec3 best = a;
  for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
    const Vec3 d = to - from;
    const Vec3 p = from + std::clamp(d.dot(q - from) / d.squaredNorm(), 0.0, 1.0) * d;
    if ((p - q).norm() < (best - q).norm()) best = p;
  }
  return best;
}

// Signed distance of a point in the body frame.
struct BodyDistance {
  const Vec3& q;

  Distance operator()(const contact::Sphere& s) const { return from_point(q, Vec3::Zero(), s.radius); }
  Distance operator()(const contact::Capsule& s) const {
    return from_point(q, Vec3(0, std::clamp(q.y(), -s.half_height, s.half_height), 0), s.radius);
  }
  Distance operator()(const contact::Box& s) const {
    const Vec3 inner = q.cwiseMax(-s.half).cwiseMin(s.half);
    if (inner != q) return from_point(q, inner);
    int axis;
    const double d = (q.cwiseAbs() - s.half).maxCoeff(&axis);
    return {d, Vec3::Unit(axis) * (q[axis] < 0 ? -1 : 1)};
  }
  Distance operator()(const contact::Cylinder& s) const {
    const double across = std::sqrt(q.x() * q.x() + q.z() * q.z());
    const Vec3 out = across > 0 ? Vec3(q.x() / across, 0, q.z() / across) : Vec3(Vec3::UnitX());
    const double r = across - s.radius, h = std::abs(q.y()) - s.half_height;
    const Vec3 up = Vec3::UnitY() * (q.y() < 0 ? -1 : 1);
    if (r > 0 && h > 0) return from_point(q, s.radius * out + s.half_height * up);
    return r > h ? Distance{r, out} : Distance{h, up};
  }
  Distance operator()(const contact::ConvexHull& s) const {
    Distance most{-std::numeric_limits<double>::infinity(), Vec3::Zero()};
    for (const auto& f : s.form->faces) {
      const double d = f.normal.dot(q) - f.offset;
      if (d > most.value) most = {d, f.normal};
    }
    return most.value > 0 ? from_point(q, nearest(*s.form)) : most;
  }
  // For a concave body only outside; its distance is not convex, so its triangles are searched one by one.
  Distance operator()(const contact::Mesh& s) const { return from_point(q, nearest(*s.form)); }
  Distance operator()(const contact::Compound&) const { return {0, Vec3::Zero()}; }

  Vec3 nearest(const contact::Polyhedron& form) const {
    Vec3 best = form.vertices[0];
    for (const auto& f : form.faces) {
      const auto corner = [&](int k) {
        return form.vertices[std::size_t(form.loop[std::size_t(f.first + k)])];
      };
      for (int k = 1; k + 1 < f.count; ++k) {
        const Vec3 p = nearest_on_triangle(q, corner(0), corner(k), corner(k + 1));
        if ((p - q).norm() < (best - q).norm()) best = p;
      }
    }
    return best;
  }
};

// Bounds of a body, local frame.
struct Ball {
  Vec3 centre;
  double radius;
};

class BruteDistance {
 public:
  // `function(q)` is the signed distance of a convex body from q, local frame; the body is in the ball.
  template <class Function>
  BruteDistance(const surface::Surface& surface, const Function& function, double reach, const Ball& ball,
                double floor = -std::numeric_limits<double>::infinity())
      : best_(reach), floor_(floor) {
    for (int j = 0; j + 1 < surface.height(); ++j) {
      for (int i = 0; i + 1 < surface.width(); ++i) {
        const surface::Cell cell = surface.cell(i, j);
        const Vec3 middle = cell.at(0.5, 0.5);
        double half = 0;
        for (int k = 0; k < 4; ++k) half = std::max(half, (cell.at(k & 1, k >> 1) - middle).norm());
        if ((middle - ball.centre).norm() > ball.radius + half + reach) continue;
        search(cell, function, measured(cell, function, 0, 0, 1), 0);
      }
    }
  }
  double value() const { return best_; }

 private:
  struct Piece {
    double s, t, size, value, least;
  };

  template <class Function>
  Piece measured(const surface::Cell& cell, const Function& function, double s, double t, double size) {
    const Distance d = function(cell.at(s + 0.5 * size, t + 0.5 * size));
    best_ = std::min(best_, d.value);
    const Vec3 a = cell.at(s + size, t + 0.5 * size) - cell.at(s, t + 0.5 * size),
               b = cell.at(s + 0.5 * size, t + size) - cell.at(s + 0.5 * size, t);
    const double twist = 0.25 * size * size * std::abs(cell.z[3] - cell.z[2] - cell.z[1] + cell.z[0]);
    return {s, t, size, d.value,
            d.value - 0.5 * std::abs(d.gradient.dot(a)) - 0.5 * std::abs(d.gradient.dot(b)) - twist};
  }

  template <class Function>
  void search(const surface::Cell& cell, const Function& function, const Piece& piece, int depth) {
    if (piece.least > best_ - 1e-9 || best_ <= floor_ || depth > 40) return;
    std::array<Piece, 4> quarter;
    const double half = 0.5 * piece.size;
    for (int k = 0; k < 4; ++k)
      quarter[std::size_t(k)] =
          measured(cell, function, piece.s + half * (k & 1), piece.t + half * (k >> 1), half);
    // The nearest first, or the best so far would creep towards it.
    std::sort(quarter.begin(), quarter.end(),
              [](const Piece& a, const Piece& b) { return a.value < b.value; });
    for (const Piece& q : quarter) search(cell, function, q, depth + 1);
  }

  double best_, floor_;  // nothing less than this is looked for
};

// The least distance of the relief (between texel centres) from a shape, or `reach` if that is less.
inline double brute_distance(const surface::Surface& surface, const contact::Shape& shape, const Pose& pose,
                             double reach) {
  if (const auto* compound = std::get_if<contact::Compound>(&shape)) {
    double least = reach;
    for (const contact::CompoundChild& child : *compound->children)
      least = std::min(
          least, brute_distance(
                     surface, child.shape,
                     {pose.to_world(child.pose.position), pose.orientation * child.pose.orientation}, least));
    return least;
  }
  const surface::Placement& place = surface.placement();
  const auto in_body = [&](const Vec3& local) { return pose.to_local(place.to_world(local)); };
  const Ball ball{place.to_local(pose.position), contact::bounding_radius(shape)};
  const auto out = [&](const Vec3& body) { return place.direction_to_local(pose.orientation * body); };
  if (const auto* mesh = std::get_if<contact::Mesh>(&shape)) {
    double least = reach;
    const auto& form = *mesh->form;
    for (std::size_t f = 0; f < form.faces.size(); ++f) {
      const auto corner = [&](std::size_t k) { return form.vertices[std::size_t(form.loop[3 * f + k])]; };
      const auto triangle = [&](const Vec3& q) {
        const Vec3 b = in_body(q);
        const Distance d = from_point(b, nearest_on_triangle(b, corner(0), corner(1), corner(2)));
        return Distance{d.value, out(d.gradient)};
      };
      least = BruteDistance(surface, triangle, least, ball, 1e-8).value();
    }
    return least;
  }
  const auto distance = [&](const Vec3& q) {
    const Vec3 b = in_body(q);
    const Distance d = std::visit(BodyDistance{b}, shape);
    return Distance{d.value, out(d.gradient)};
  };
  return BruteDistance(surface, distance, reach, ball).value();
}

}  // namespace intaglio::tests
