#include "haptics/proxy.h"
#include "intaglio/representation.h"

#include <algorithm>
#include <cmath>

namespace intaglio::haptics {

namespace {

// How far Surface::smooth() leaves the range of its texels, as a fraction of that range.
//
// Catmull-Rom's weights sum to 1; half way between two texels, where they differ most from those of a mean,
// they are -1/16, 9/16, 9/16, -1/16. With N = 1/8 the size of the negative ones, the positive ones sum to 1 +
// N, and along one axis the curve overshoots by at most N. In two dimensions weights multiply, and two
// negative ones make a positive one: the positive products sum to (1 + N)^2 + N^2, so that the overshoot is 2
// N + 2 N^2 = 9/32. It is attained where exactly the texels with a positive weight are high. Mip levels and
// blends of them are means of texels and stay within.
constexpr double overshoot = 9.0 / 32;

double mean_height(const surface::Surface& s) {
  const double coarsest = 4 * std::max(s.placement().size_u(), s.placement().size_v());
  return s.smooth({0.5, 0.5}, coarsest).height;
}

}  // namespace

FeltRelief::FeltRelief(std::shared_ptr<const surface::Surface> surface, const SolidOptions& options)
    : surface_(std::move(surface)),
      footprint_(options.footprint),
      flat_(options.representation == Representation::flat || surface_->is_flat()) {
  if (flat_) return;
  if (options.representation == Representation::normal) offset_ = mean_height(*surface_);
  top_ = overshoot * surface_->max_depth() - offset_;
}

TexturedSlab::TexturedSlab(std::shared_ptr<const surface::Surface> surface, const SolidOptions& options)
    : relief_(std::move(surface), options), thickness_(options.thickness) {}

Penetration TexturedSlab::at(const Vec3& p) const {
  const surface::Placement& place = relief_.surface().placement();
  const Vec3 local = place.to_local(p);
  // The nearest of the four sides and the underside.
  Penetration nearest{local.x(), Vec3::UnitX()};
  const auto offer = [&](double depth, const Vec3& gradient) {
    if (depth < nearest.depth) nearest = {depth, gradient};
  };
  offer(place.size_u() - local.x(), -Vec3::UnitX());
  offer(local.y(), Vec3::UnitY());
  offer(place.size_v() - local.y(), -Vec3::UnitY());
  offer(local.z() + thickness_, Vec3::UnitZ());
  // Above the top, depths are negative and need not be exact.
  if (local.z() > relief_.top()) {
    offer(relief_.top() - local.z(), -Vec3::UnitZ());
  } else if (nearest.depth > 0) {
    const surface::Smooth s = relief_.at(place.uv(local));
    offer(s.height - local.z(), {s.gradient.x(), s.gradient.y(), -1});
  }
  return {nearest.depth, place.direction_to_world(nearest.gradient)};
}

TexturedMesh::TexturedMesh(std::shared_ptr<const surface::Surface> surface, surface::MeshPlacement mesh,
                           double reach, const SolidOptions& options)
    : relief_(std::move(surface), options), mesh_(std::move(mesh)), reach_(std::max(reach, relief_.top())) {}

Penetration TexturedMesh::at(const Vec3& p) const {
  const auto base = mesh_.closest(p, reach_);
  if (!base) return {};
  const surface::Smooth s = relief_.at(base->uv);
  const surface::Placement& place = relief_.surface().placement();
  // Slope per unit of (u, v), then along the base: times the inverse transpose of the Jacobian of base over
  // (u, v).
  const Vec2 per_uv(s.gradient.x() * place.size_u(), s.gradient.y() * place.size_v());
  const Eigen::Matrix2d stretch = mesh_.stretch(*base);
  const double area = stretch.determinant();
  Vec2 slope = Vec2::Zero();
  if (std::abs(area) > 1e-300) {
    slope = {(stretch(1, 1) * per_uv.x() - stretch(1, 0) * per_uv.y()) / area,
             (stretch(0, 0) * per_uv.y() - stretch(0, 1) * per_uv.x()) / area};
  }
  return {s.height - base->height, base->direction_to_world({slope.x(), slope.y(), -1})};
}

namespace {

constexpr double converged = 1e-7;  // m: a tenth of a millinewton
constexpr int max_steps = 3;

}  // namespace

void Proxy::start(const Solid& solid, const Vec3& x) {
  y_ = x;
  at_ = solid.at(y_);
  for (int k = 0; k < 4 && at_.depth > 0; ++k) {
    y_ -= (1 + 1e-9) * at_.depth / at_.gradient.squaredNorm() * at_.gradient;
    at_ = solid.at(y_);
  }
  started_ = true;
}

double Proxy::energy(const Vec3& x, const ContactSprings& k, const Vec3& y, double depth) const {
  const double inside = std::max(depth, 0.0);
  return 0.5 * (k.coupling * (x - y).squaredNorm() + k.surface * inside * inside);
}

// The step from y0 = y_ to the minimum of W with the depth linearised about y0, as far as friction allows.
//
// With g the gradient of the depth d at y0, minimise over y
//
//     1/2 Kc |x - y|^2 + 1/2 Ks (d + g.(y - y0))^2.
//
// Its derivative, Kc (y - x) + Ks (d + g.(y - y0)) g, vanishes for y = x - lambda g. With D = d + g.(x - y0),
// the linearised depth at the tip itself, the spring of the surface is compressed by D - lambda g2 (g2 =
// |g|^2), so that
//
//     Kc lambda = Ks (D - lambda g2),     lambda = Ks D / (Kc + Ks g2).
//
// D <= 0 means that the tip is free, and y = x. The force on the hand is Kc (y - x) = -Kc lambda g. For a
// relief g = (slope, -1) in the base's frame: the force's component along the base normal, the load, is Kc
// lambda.
//
// The part of the step along g is always taken. The pull that remains across g, were that part alone taken,
// is Kc |t| with t the tangential part: within friction * load the proxy sticks; beyond, it slips until the
// pull is friction * load.
Vec3 Proxy::step(const Vec3& x, const ContactSprings& k, double friction) const {
  const Vec3& g = at_.gradient;
  const double g2 = g.squaredNorm();
  const double depth = at_.depth + g.dot(x - y_);
  if (depth <= 0) return x - y_;
  const double lambda = k.surface * depth / (k.coupling + k.surface * g2);
  const Vec3 to_minimum = x - lambda * g - y_;
  if (friction == 0) return to_minimum;
  const double load = k.coupling * lambda;
  const Vec3 normal_part = to_minimum.dot(g) / g2 * g;
  const Vec3 tangential = to_minimum - normal_part;
  const double pull = k.coupling * tangential.norm();
  if (pull <= friction * load) return normal_part;
  return normal_part + (1 - friction * load / pull) * tangential;
}

// Moves along `step`, shortened until W does not grow; false if it would grow.
bool Proxy::descend(const Solid& solid, const Vec3& x, const ContactSprings& k, const Vec3& step,
                    int& samples) {
  const double before = energy(x, k, y_, at_.depth);
  const auto slope = [&](const Vec3& y, const Penetration& at) {
    return (k.coupling * (y - x) + k.surface * std::max(at.depth, 0.0) * at.gradient).dot(step);
  };
  const double slope_here = slope(y_, at_);
  double length = 1;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const Vec3 y = y_ + length * step;
    const Penetration at = solid.at(y);
    ++samples;
    if (energy(x, k, y, at.depth) <= before) {
      y_ = y;
      at_ = at;
      return true;
    }
    // Line search: secant estimate of the minimum from the slopes at both ends.
    const double slope_there = slope(y, at);
    const double secant = slope_here < 0 && slope_there > 0 ? -slope_here / (slope_there - slope_here) : 0.5;
    length *= std::clamp(secant, 0.05, 0.9);
  }
  return false;
}

Proxy::Contact Proxy::move(const Solid& solid, const Vec3& x, const ContactSprings& k, double friction) {
  Contact contact;
  if (!started_) {
    start(solid, x);
    contact.samples = 1;
  }
  for (int n = 0; n < max_steps; ++n) {
    const Vec3 next = step(x, k, friction);
    if (next.squaredNorm() < converged * converged) break;
    if (!descend(solid, x, k, next, contact.samples)) break;
  }
  contact.force = k.coupling * (y_ - x);
  contact.energy = energy(x, k, y_, at_.depth);
  contact.touching = contact.energy > 1e-12;  // smaller energies are convergence residue
  contact.normal = -at_.gradient.normalized();
  return contact;
}

}  // namespace intaglio::haptics
