#include "intaglio/sound/fem/surface_query.h"

#include <cmath>

namespace intaglio::sound {

namespace {

constexpr double same_place = 1e-6;  // of the line: triangles that meet there are met as one

// Where, in units of `along`, a line from p meets the triangle; not when it runs within its plane.
std::optional<double> meeting(const Vec3& p, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 across = along.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0) return std::nullopt;
  const Vec3 from = p - a;
  const Vec3 up = from.cross(ab);
  const double u = from.dot(across) / determinant, v = along.dot(up) / determinant;
  constexpr double margin = 1e-9;
  if (u < -margin || v < -margin || u + v > 1 + margin) return std::nullopt;
  return ac.dot(up) / determinant;
}

}  // namespace

Result<SurfaceQuery> SurfaceQuery::make(const BodySurface& body, const std::string& name) {
  surface::TriangleMesh mesh;
  mesh.positions = body.points;
  mesh.triangles.assign(body.triangles.begin(), body.triangles.end());
  auto tree = surface::TriangleTree::make(mesh, name);
  if (!tree) return tl::unexpected(tree.error());
  return SurfaceQuery(body, std::move(*tree));
}

std::optional<SurfaceQuery::Foot> SurfaceQuery::foot(const Vec3& p, double reach) const {
  std::optional<Foot> best;
  tree_.search(p, reach, [&](int t) {
    const Triangle& corner = body_->triangles[std::size_t(t)];
    const Vec3 &a = body_->points[std::size_t(corner[0])], &b = body_->points[std::size_t(corner[1])],
               &c = body_->points[std::size_t(corner[2])];
    const Vec3 w = nearest_barycentric(p, a, b, c);
    const Vec3 at = w[0] * a + w[1] * b + w[2] * c;
    if ((at - p).norm() < reach) {
      reach = (at - p).norm();
      best = {at, t, w};
    }
    return reach;
  });
  return best;
}

std::optional<Vec3> SurfaceQuery::nearest(const Vec3& p, double reach) const {
  const auto found = foot(p, reach);
  return found ? std::optional(found->point) : std::nullopt;
}

double SurfaceQuery::distance(const Vec3& p, double reach) const {
  const auto found = foot(p, reach);
  return found ? (found->point - p).norm() : reach;
}

std::optional<double> SurfaceQuery::only_crossing(const Vec3& a, const Vec3& b) const {
  const double radius = 0.5 * (b - a).norm();
  std::optional<double> only;
  bool several = false;
  tree_.search(0.5 * (a + b), radius, [&](int triangle) {
    const Triangle& corner = body_->triangles[std::size_t(triangle)];
    const auto t = meeting(a, b - a, body_->points[std::size_t(corner[0])],
                           body_->points[std::size_t(corner[1])], body_->points[std::size_t(corner[2])]);
    if (!t || *t < 0 || *t > 1) return radius;
    if (only && std::abs(*t - *only) > same_place) several = true;
    // Of those at one place always the same, whatever order they come in.
    if (!only || *t < *only) only = t;
    return radius;
  });
  return several ? std::nullopt : only;
}

}  // namespace intaglio::sound
