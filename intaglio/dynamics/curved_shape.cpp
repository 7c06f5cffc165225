#include "intaglio/dynamics/curved_shape.h"

#include "intaglio/contact/curved_relief.h"
#include "intaglio/dynamics/bullet_vec.h"

namespace intaglio::dynamics {

namespace {

std::array<Vec3, 3> corners_of(const surface::ReliefMesh& relief, int triangle) {
  return {relief.point(triangle, Vec3::UnitX()), relief.point(triangle, Vec3::UnitY()),
          relief.point(triangle, Vec3::UnitZ())};
}

}  // namespace

CurvedShape::CurvedShape(surface::ReliefMesh relief) : relief_(std::move(relief)) {
  const surface::Box bounds = relief_.bounds();
  look_ahead_ = 0.25 * bounds.sizes().maxCoeff();
  low_ = to_bullet(Vec3(bounds.min()));
  high_ = to_bullet(Vec3(bounds.max()));
}

contact::ContactSet CurvedShape::contacts(const contact::Shape& body, const Pose& pose, double margin) const {
  return curved_contacts(relief_, body, pose, margin);
}

void CurvedShape::calculateLocalInertia(btScalar mass, btVector3& inertia) const {
  const auto count = static_cast<int>(relief_.base().mesh().triangles.size());
  double volume = 0;
  Vec3 squares = Vec3::Zero();  // the integrals of x^2, y^2, z^2
  for (int k = 0; k < count; ++k) {
    const auto [a, b, c] = corners_of(relief_, k);
    const double part = a.dot(b.cross(c)) / 6;
    volume += part;
    const Vec3 sum = a + b + c;
    squares += part / 20 * (a.cwiseAbs2() + b.cwiseAbs2() + c.cwiseAbs2() + sum.cwiseAbs2());
  }
  const Vec3 box = relief_.bounds().sizes();
  if (!(volume > 1e-3 * box.prod())) {
    squares = box.cwiseAbs2() / 12;
    volume = 1;
  }
  squares *= static_cast<double>(mass) / volume;
  inertia = to_bullet(Vec3(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y()));
}

void CurvedShape::processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                                      const btVector3& high) const {
  const surface::Box wanted(from_bullet(low), from_bullet(high));
  relief_.for_each_triangle(wanted, [&](int k) {
    const auto [a, b, c] = corners_of(relief_, k);
    btVector3 corners[3] = {to_bullet(a), to_bullet(b), to_bullet(c)};
    callback->processTriangle(corners, k, 0);
  });
}

}  // namespace intaglio::dynamics
