#include "intaglio/dynamics/textured_shape.h"

#include <algorithm>
#include <cmath>

#include "intaglio/contact/relief.h"
#include "intaglio/dynamics/bullet_vec.h"
#include "intaglio/surface/implied.h"

namespace intaglio::dynamics {

TexturedShape::TexturedShape(std::shared_ptr<const surface::Surface> surface, const ContactOptions& options,
                             double thickness)
    : TouchableShape(thickness), surface_(std::move(surface)), relief_(surface_), options_(options) {
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
  if (options_.representation == Representation::flat) return flat_contacts(*surface_, body, pose, margin);
  if (options_.representation == Representation::normal && options_.normal_method == NormalMethod::literal)
    return normal_map_contacts(*surface_, body, pose, margin);
  return options_.method == ContactMethod::closest ? relief_contacts(*relief_, body, pose, margin)
                                                   : directional_contacts(*relief_, body, pose, margin);
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
    return static_cast<int>(std::clamp(std::floor(x / texel - 0.5), -1.0, count - 1.0));
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

}  // namespace intaglio::dynamics
