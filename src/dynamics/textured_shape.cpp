#include "dynamics/textured_shape.h"

#include <algorithm>
#include <cmath>

#include "contact/curved_body.h"
#include "contact/curved_contacts.h"
#include "contact/relief_relief.h"
#include "contact/surface_contacts.h"
#include "dynamics/bullet_shape.h"
#include "intaglio/representation.h"
#include "surface/fuse.h"

namespace intaglio::dynamics {

namespace {

// The same contacts as seen from the other shape, which is at `pose` in this one's frame.
contact::ContactSet swap_roles(contact::ContactSet set, const Pose& pose, const CurvedShape& other) {
  for (std::size_t k = 0; k < set.count; ++k) {
    contact::ContactPoint& c = set.points[k];
    c.point = pose.to_local(c.point + c.distance * c.normal);
    c.normal = pose.orientation.conjugate() * -c.normal;
    const TextureSite site = other.site_at(c.point).value_or(TextureSite{0, Vec2::Zero(), c.normal});
    c.uv = site.uv;
    c.n_s = site.n_s;
    c.triangle = site.triangle;
    c.weights = site.weights;
  }
  return set;
}

Pose inverse(const Pose& pose) {
  return {pose.orientation.conjugate() * -pose.position, pose.orientation.conjugate()};
}

}  // namespace

std::optional<TextureSite> site_under(const surface::ReliefMesh& relief, const Vec3& point, double reach) {
  const auto base = relief.base().closest(point, reach);
  if (!base) return std::nullopt;
  const Vec3 n_s = base->direction_to_world(relief.surface().normal(base->uv));
  return TextureSite{0, base->uv, n_s, base->triangle, base->weights};
}

contact::ContactSet TexturedShapeBase::within_thickness(contact::ContactSet set) const {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < set.count; ++k)
    if (set.points[k].distance >= -thickness_) set.points[kept++] = set.points[k];
  set.count = kept;
  return set;
}

contact::ContactSet relief_pair_contacts(const TexturedShapeBase& body, const Pose& pose,
                                         const TexturedShapeBase& ground, double margin) {
  const auto* flat_body = dynamic_cast<const TexturedShape*>(&body);
  const auto* flat_ground = dynamic_cast<const TexturedShape*>(&ground);
  const auto* curved_body = dynamic_cast<const CurvedShape*>(&body);
  const auto* curved_ground = dynamic_cast<const CurvedShape*>(&ground);
  if (flat_body && flat_ground) {
    // Faces with the same orientation cannot touch.
    const Vec3 up = pose.orientation * flat_body->relief().placement().n();
    if (up.dot(flat_ground->relief().placement().n()) > 0.5) return {};
    return contact::relief_relief_contacts({flat_body->relief(), pose}, {flat_ground->relief(), {}}, margin);
  }
  // Many pieces of a curved body are nearly as low as the lowest; a smaller margin keeps the query bounded.
  margin = std::min(margin, 0.3 * std::min(body.texel(), ground.texel()));
  if (curved_body && flat_ground)
    return body.within_thickness(contact::curved_on_relief(curved_body->relief(), pose, flat_ground->relief(),
                                                           margin, ground.thickness()));
  if (flat_body && curved_ground) {
    const Pose back = inverse(pose);
    return ground.within_thickness(
        swap_roles(contact::curved_on_relief(curved_ground->relief(), back, flat_body->relief(), margin,
                                             body.thickness()),
                   back, *curved_ground));
  }
  if (curved_body && curved_ground) {
    // Deep enough to prevent tunnelling, shallow enough not to enclose a small body.
    const double size = curved_body->relief().bounds().sizes().minCoeff();
    const double depth = std::min({0.25 * size, body.thickness(), ground.thickness()});
    return contact::curved_on_curved(curved_body->relief(), pose, curved_ground->relief(), margin, depth);
  }
  return {};
}

TexturedShape::TexturedShape(std::shared_ptr<const surface::Surface> surface, const ContactOptions& options,
                             double thickness)
    : TexturedShapeBase(thickness), surface_(std::move(surface)), relief_(surface_), options_(options) {
  if (options_.representation == Representation::normal && options_.normal_method == NormalMethod::implied) {
    const surface::ImpliedRelief implied = implied_relief(*surface_);
    relief_ = implied.surface;
    mean_slope_ = implied.mean_slope;
  }
  const surface::Placement& place = relief_->placement();
  look_ahead_ = 0.25 * std::min(place.size_u(), place.size_v());
  low_.setValue(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
  high_ = -low_;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 local((corner & 1) != 0 ? place.size_u() : 0, (corner & 2) != 0 ? place.size_v() : 0,
                     (corner & 4) != 0 ? -relief_->max_depth() - std::min(look_ahead_, thickness) : 0);
    const btVector3 at = to_bullet(place.to_world(local));
    low_.setMin(at);
    high_.setMax(at);
  }
}

contact::ContactSet TexturedShape::contacts(const contact::Shape& body, const Pose& pose,
                                            double margin) const {
  return within_thickness(all_contacts(body, pose, margin));
}

contact::ContactSet TexturedShape::all_contacts(const contact::Shape& body, const Pose& pose,
                                                double margin) const {
  if (options_.representation == Representation::flat)
    return contact::flat_contacts(*surface_, body, pose, margin);
  if (options_.representation == Representation::normal && options_.normal_method == NormalMethod::literal)
    return contact::normal_map_contacts(*surface_, body, pose, margin);
  return options_.method == ContactMethod::closest
             ? contact::relief_contacts(*relief_, body, pose, margin)
             : contact::directional_contacts(*relief_, body, pose, margin);
}

std::optional<TextureSite> TexturedShape::site(const contact::ContactPoint& c) const {
  return TextureSite{0, c.uv, relief_ == surface_ ? c.n_s : surface_->world_normal(c.uv)};
}

std::optional<TextureSite> TexturedShape::site_at(const Vec3& point) const {
  const surface::Placement& place = surface_->placement();
  const Vec2 uv = place.uv(place.to_local(point)).cwiseMax(0).cwiseMin(1);
  return TextureSite{0, uv, surface_->world_normal(uv)};
}

void TexturedShape::calculateLocalInertia(btScalar mass, btVector3& inertia) const {
  const surface::Placement& place = relief_->placement();
  const double least = 0.01 * std::max(place.size_u(), place.size_v());
  const btVector3 size =
      to_bullet(place.size_u() * place.t().cwiseAbs() + place.size_v() * place.b().cwiseAbs() +
                std::max(least, relief_->max_depth()) * place.n().cwiseAbs());
  const btVector3 s2 = size * size;
  inertia.setValue(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y());
  inertia *= mass / 12;
}

void TexturedShape::processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                                        const btVector3& high) const {
  const surface::Placement& place = relief_->placement();
  Eigen::AlignedBox3d box;
  for (int corner = 0; corner < 8; ++corner) {
    box.extend(place.to_local(
        {corner & 1 ? low.x() : high.x(), corner & 2 ? low.y() : high.y(), corner & 4 ? low.z() : high.z()}));
  }
  const auto cell = [](double x, double texel, int count) {
    return int(std::clamp(std::floor(x / texel - 0.5), -1.0, count - 1.0));
  };
  const int i0 = cell(box.min().x(), relief_->texel_u(), relief_->width()),
            i1 = cell(box.max().x(), relief_->texel_u(), relief_->width());
  const int j0 = cell(box.min().y(), relief_->texel_v(), relief_->height()),
            j1 = cell(box.max().y(), relief_->texel_v(), relief_->height());
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) {
      const surface::Cell c = relief_->cell(i, j);
      const auto at = [&](double x, double y, std::size_t k) {
        return to_bullet(
            place.to_world({std::clamp(x, 0.0, place.size_u()), std::clamp(y, 0.0, place.size_v()), c.z[k]}));
      };
      btVector3 one[3] = {at(c.x0, c.y0, 0), at(c.x1, c.y0, 1), at(c.x0, c.y1, 2)};
      btVector3 two[3] = {at(c.x1, c.y0, 1), at(c.x1, c.y1, 3), at(c.x0, c.y1, 2)};
      callback->processTriangle(one, 2 * i, j);
      callback->processTriangle(two, 2 * i + 1, j);
    }
  }
}

namespace {

std::array<Vec3, 3> corners_of(const surface::ReliefMesh& relief, int triangle) {
  return {relief.point(triangle, Vec3::UnitX()), relief.point(triangle, Vec3::UnitY()),
          relief.point(triangle, Vec3::UnitZ())};
}

}  // namespace

CurvedShape::CurvedShape(surface::ReliefMesh relief, double thickness)
    : TexturedShapeBase(thickness), relief_(std::move(relief)) {
  const surface::Bounds bounds = relief_.bounds();
  look_ahead_ = 0.25 * bounds.sizes().maxCoeff();
  low_ = to_bullet(Vec3(bounds.min()));
  high_ = to_bullet(Vec3(bounds.max()));
}

contact::ContactSet CurvedShape::contacts(const contact::Shape& body, const Pose& pose, double margin) const {
  return within_thickness(contact::curved_contacts(relief_, body, pose, margin));
}

std::optional<TextureSite> CurvedShape::site(const contact::ContactPoint& c) const {
  if (c.triangle < 0) return std::nullopt;
  return TextureSite{0, c.uv, c.n_s, c.triangle, c.weights};
}

std::optional<TextureSite> CurvedShape::site_at(const Vec3& point) const {
  const double rounding = 1e-6 * relief_.bounds().sizes().maxCoeff();
  return site_under(relief_, point, relief_.surface().max_depth() + rounding);
}

contact::MassProperties CurvedShape::mass_properties() const {
  contact::EnclosedMass sum;
  const auto count = int(relief_.base().mesh().triangles.size());
  for (int k = 0; k < count; ++k) {
    const auto [a, b, c] = corners_of(relief_, k);
    sum.add(a, b, c);
  }
  contact::MassProperties out = sum.properties();
  const bool is_solid = out.volume > 1e-3 * relief_.bounds().sizes().prod();
  return is_solid && out.centre.allFinite() ? out : contact::MassProperties{};
}

void CurvedShape::calculateLocalInertia(btScalar mass, btVector3& inertia) const {
  const contact::MassProperties solid = mass_properties();
  if (solid.volume > 0) {
    const Vec3 shift = solid.centre;
    const Vec3 about =
        solid.inertia.diagonal() / solid.volume + Vec3::Constant(shift.squaredNorm()) - shift.cwiseAbs2();
    inertia = to_bullet(Vec3(double(mass) * about));
    return;
  }
  const Vec3 squares = relief_.bounds().sizes().cwiseAbs2() * double(mass) / 12;
  inertia = to_bullet(Vec3(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y()));
}

void CurvedShape::processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                                      const btVector3& high) const {
  const surface::Bounds wanted(from_bullet(low), from_bullet(high));
  relief_.for_each_triangle(wanted, [&](int k) {
    const auto [a, b, c] = corners_of(relief_, k);
    btVector3 corners[3] = {to_bullet(a), to_bullet(b), to_bullet(c)};
    callback->processTriangle(corners, k, 0);
  });
}

}  // namespace intaglio::dynamics
