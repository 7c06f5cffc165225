#include "intaglio/dynamics/textured_body.h"

#include <algorithm>
#include <cmath>

#include "intaglio/dynamics/bullet_vec.h"
#include "intaglio/dynamics/curved_shape.h"
#include "intaglio/dynamics/textured_shape.h"

namespace intaglio::dynamics {

namespace {

// A box between two corners.
struct Sides {
  Vec3 low, high;

  explicit Sides(const Vec3& half) : low(-half), high(half) {}
  // On the side that the normal leaves by.
  void set_back(const Vec3& normal, double by) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    if (normal[axis] > 0) {
      high[axis] = std::max(high[axis] - by, low[axis] + 1e-6);
    } else {
      low[axis] = std::min(low[axis] + by, high[axis] - 1e-6);
    }
  }
  Vec3 middle() const { return 0.5 * (low + high); }
  contact::Box box() const { return {0.5 * (high - low)}; }
  double across(const Vec3& normal) const { return normal.cwiseAbs().dot(high - low); }
};

double mean_depth(const surface::Surface& s) {
  double sum = 0;
  for (int j = 0; j < s.height(); ++j)
    for (int i = 0; i < s.width(); ++i) sum -= s.texel_z(i, j);
  return s.has_depth() ? sum / (static_cast<double>(s.width()) * s.height()) : 0;
}

const contact::Box* box_of(const ShapeBody& body) {
  return body.faces.empty() ? nullptr : std::get_if<contact::Box>(&body.shape);
}

}  // namespace

contact::MassProperties mass_properties(const ShapeBody& body) {
  if (body.skin) return CurvedShape(*body.skin).enclosed();
  const contact::Box* box = box_of(body);
  if (box == nullptr) return contact::mass_properties(body.shape);
  Sides sides(box->half);
  for (const auto& face : body.faces) sides.set_back(face->placement().n(), mean_depth(*face));
  contact::MassProperties out = contact::mass_properties(sides.box());
  out.centre = sides.middle();
  return out;
}

double reach(const ShapeBody& body) {
  const double plain = contact::bounding_radius(body.shape);
  if (!body.skin) return plain;
  const surface::Box bounds = body.skin->bounds();
  return std::max(plain, bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs()).norm());
}

double texel(const ShapeBody& body) {
  if (body.skin) return body.skin->texel();
  double least = 0;
  for (const auto& face : body.faces) {
    const double own = std::min(face->texel_u(), face->texel_v());
    least = least > 0 ? std::min(least, own) : own;
  }
  return least;
}

BulletShape to_bullet(const ShapeBody& body, const Pose& held) {
  BulletShape out;
  auto whole = std::make_unique<btCompoundShape>();
  const auto add = [&](std::unique_ptr<btCollisionShape> part, const Pose& pose) {
    out.parts.push_back(std::move(part));
    whole->addChildShape(to_bullet(pose), out.parts.back().get());
  };
  const contact::Box* box = box_of(body);
  if (body.skin) {
    add(std::make_unique<CurvedShape>(*body.skin), held);
  } else if (box != nullptr) {
    Sides core(box->half);
    for (const auto& face : body.faces) {
      const Vec3 n = face->placement().n();
      const double texel = std::max(face->texel_u(), face->texel_v());
      const double thickness = std::min(face->max_depth() + texel, 0.5 * Sides(box->half).across(n));
      add(std::make_unique<TexturedShape>(face, ContactOptions{}, thickness), held);
      core.set_back(n, face->max_depth());
    }
    add(std::make_unique<btBoxShape>(to_bullet(core.box().half)),
        {held.to_world(core.middle()), held.orientation});
  } else {
    return to_bullet(body.shape, held);
  }
  out.parts.push_back(std::move(whole));
  return out;
}

surface::ReliefMesh bare(const surface::ReliefMesh& relief) {
  surface::Texels flat;
  flat.width = flat.height = 4;
  flat.depth.assign(16, 0.0f);
  flat.normal.assign(16, Vec3::UnitZ());
  const auto plane = std::make_shared<const surface::Surface>(std::move(flat), relief.surface().placement(),
                                                              0.0, surface::Edge::wrap);
  auto made = surface::ReliefMesh::make(plane, relief.base());
  return made ? *made : relief;  // what has no depth cannot fold
}

}  // namespace intaglio::dynamics
