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

CurvedShape::CurvedShape(surface::ReliefMesh relief, double thickness)
    : TouchableShape(thickness), relief_(std::move(relief)) {
  const surface::Box bounds = relief_.bounds();
  look_ahead_ = 0.25 * bounds.sizes().maxCoeff();
  low_ = to_bullet(Vec3(bounds.min()));
  high_ = to_bullet(Vec3(bounds.max()));
}

contact::ContactSet CurvedShape::contacts(const contact::Shape& body, const Pose& pose, double margin) const {
  return within_thickness(curved_contacts(relief_, body, pose, margin));
}

contact::MassProperties CurvedShape::enclosed() const {
  contact::EnclosedMass sum;
  const auto count = static_cast<int>(relief_.base().mesh().triangles.size());
  for (int k = 0; k < count; ++k) {
    const auto [a, b, c] = corners_of(relief_, k);
    sum.add(a, b, c);
  }
  contact::MassProperties out = sum.properties();
  const bool is_solid = out.volume > 1e-3 * relief_.bounds().sizes().prod();
  return is_solid && out.centre.allFinite() ? out : contact::MassProperties{};
}

void CurvedShape::calculateLocalInertia(btScalar mass, btVector3& inertia) const {
  const contact::MassProperties whole = enclosed();
  if (whole.volume > 0) {
    const Vec3 shift = whole.centre;
    const Vec3 about =
        whole.inertia.diagonal() / whole.volume + Vec3::Constant(shift.squaredNorm()) - shift.cwiseAbs2();
    inertia = to_bullet(Vec3(static_cast<double>(mass) * about));
    return;
  }
  const Vec3 squares = relief_.bounds().sizes().cwiseAbs2() * static_cast<double>(mass) / 12;
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
