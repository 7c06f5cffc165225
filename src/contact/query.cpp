#include "contact/query.h"

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"

namespace intaglio::contact {

namespace {

// A gap counts against a point as if it were so many times as far inside: a body that leans by 1.4 degrees
// closes it.
constexpr double gap_weight = 40;

ContactPoint reported(const surface::Surface& surface, const Candidate& c) {
  const surface::Placement& place = surface.placement();
  const Vec2 uv = place.uv(c.point);
  return {place.to_world(c.point),
          place.direction_to_world(c.normal),
          surface.world_normal(uv),
          c.distance,
          uv,
          c.feature};
}

}  // namespace

void Candidates::add(const Candidate& candidate) {
  if (!(candidate.distance <= limit_)) return;
  overlaps_ = overlaps_ || candidate.distance < 0;
  if (count_ < capacity) {
    kept_[count_++] = candidate;
    if (count_ == capacity) find_shallowest();
    return;
  }
  overflowed_ = true;
  kept_[shallowest_] = candidate;
  find_shallowest();
}

void Candidates::find_shallowest() {
  shallowest_ = static_cast<std::size_t>(
      std::max_element(begin(), end(),
                       [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; }) -
      begin());
  limit_ = std::min(limit_, kept_[shallowest_].distance);
}

bool Candidates::use_spare() {
  if (overlaps_ || !(has_spare_ || has_witness_)) return false;
  add(has_spare_ ? spare_ : witness_);
  return true;
}

std::size_t Candidates::choose(Chosen& chosen) {
  std::sort(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(count_),
            [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  std::size_t count = 0;
  std::array<bool, capacity> used{};
  const auto take = [&](std::size_t k) {
    used[k] = true;
    chosen[count++] = &kept_[k];
  };
  // Deepest first: whatever pushes another way. Two places are left for support.
  const double cos_angle = elementary::cos(min_angle);
  for (std::size_t k = 0; k < count_ && count + 2 < chosen.size(); ++k) {
    const bool differs =
        std::all_of(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](const Candidate* c) { return c->normal.dot(kept_[k].normal) < cos_angle; });
    if (count == 0 || differs) take(k);
  }
  // Then whichever is farthest from all chosen, gaps counted against it.
  while (count > 0 && count < chosen.size()) {
    std::size_t best = count_;
    double best_score = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      if (used[k]) continue;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t n = 0; n < count; ++n)
        nearest = std::min(nearest, (chosen[n]->point - kept_[k].point).norm());
      const double score = nearest - gap_weight * (kept_[k].distance - chosen[0]->distance);
      // A point beside a chosen one adds nothing.
      if (nearest < 1e-9 || (best < count_ && score <= best_score)) continue;
      best = k;
      best_score = score;
    }
    if (best == count_) break;
    take(best);
  }
  std::sort(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Candidate* a, const Candidate* b) { return a->distance < b->distance; });
  return count;
}

void Candidates::choose(const surface::Surface& surface, ContactSet& set) {
  Chosen chosen;
  const std::size_t count = choose(chosen);
  for (std::size_t k = 0; k < count; ++k) set.points[set.count++] = reported(surface, *chosen[k]);
}

namespace {

bool is_size(double size) {
  return size > 0 && std::isfinite(size);
}

struct HasSize {
  bool operator()(const Sphere& s) const { return is_size(s.radius); }
  bool operator()(const Capsule& s) const { return is_size(s.radius) && is_size(s.half_height); }
  bool operator()(const Box& s) const { return is_size(s.half.minCoeff()) && s.half.allFinite(); }
  bool operator()(const Cylinder& s) const { return is_size(s.radius) && is_size(s.half_height); }
  bool operator()(const ConvexHull& s) const { return s.form != nullptr; }
  bool operator()(const Mesh& s) const { return s.form != nullptr; }
  bool operator()(const Compound& s) const { return s.children != nullptr && !s.children->empty(); }
};

}  // namespace

bool is_rigid(const Pose& pose) {
  const double norm2 = pose.orientation.squaredNorm();
  return pose.position.allFinite() && norm2 > 1e-12 && norm2 < 1e12;
}

bool has_size(const Shape& shape) {
  return std::visit(HasSize{}, shape);
}

Question::Question(const surface::Surface& asked, const Shape& shape, const Pose& pose, double wanted_margin)
    : surface(asked), frame{}, reach(0), margin(0), wrong(status::ok), hopeless(true) {
  const surface::Placement& place = surface.placement();
  if (!is_rigid(pose)) {
    wrong = status::bad_pose;
    return;
  }
  if (!has_size(shape)) {
    wrong = status::no_size;
    return;
  }
  reach = bounding_radius(shape);
  if (!std::isfinite(reach)) {
    wrong = status::no_size;
    return;
  }
  const double side = std::min(place.size_u(), place.size_v());
  margin = wanted_margin > 0 ? std::min(wanted_margin, side) : 0;
  if (!(wanted_margin <= side)) wrong |= status::wide_margin;
  frame.origin = place.to_local(pose.position);
  if (frame.origin.norm() > 1e5 * std::max(place.size_u(), place.size_v())) {
    wrong |= status::far;
    return;
  }
  const Mat3 turn = pose.orientation.normalized().toRotationMatrix();
  for (int k = 0; k < 3; ++k) frame.axes.col(k) = place.direction_to_local(turn.col(k));
  const double wide = reach + margin;
  const Vec3& at = frame.origin;
  if (at.x() < -wide || at.y() < -wide || at.x() > place.size_u() + wide || at.y() > place.size_v() + wide) {
    wrong |= status::off_edge;
    return;
  }
  hopeless = at.z() > wide;
}

}  // namespace intaglio::contact
