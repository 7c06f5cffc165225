#include "contact/query.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/portable_math.h"

namespace intaglio::contact {

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

// A gap is weighted by 1 / tan(1.4 degrees): tilting the body by 1.4 degrees about the selected points closes
// it.
constexpr double gap_weight = 40;

ContactPoint to_contact_point(const surface::Surface& surface, const Candidate& c) {
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

Frame local_frame(const surface::Placement& place, const Pose& pose) {
  Frame frame{Mat3(), place.to_local(pose.position)};
  const Mat3 turn = pose.orientation.normalized().toRotationMatrix();
  for (int k = 0; k < 3; ++k) frame.axes.col(k) = place.direction_to_local(turn.col(k));
  return frame;
}

bool is_rigid(const Pose& pose) {
  const double norm2 = pose.orientation.squaredNorm();
  return pose.position.allFinite() && norm2 > 1e-12 && norm2 < 1e12;
}

bool has_size(const Shape& shape) {
  return std::visit(HasSize{}, shape);
}

unsigned limit_margin(double& margin, double side) {
  const unsigned status = margin <= side ? status::ok : status::wide_margin;
  margin = margin > 0 ? std::min(margin, side) : 0;
  return status;
}

QuerySetup::QuerySetup(const surface::Surface& ground, const Shape& shape, const Pose& pose,
                       double wanted_margin)
    : surface(ground), frame{} {
  const surface::Placement& place = surface.placement();
  if (!is_rigid(pose)) {
    status = status::bad_pose;
    return;
  }
  if (has_size(shape)) bounding_radius = contact::bounding_radius(shape);
  if (!has_size(shape) || !std::isfinite(bounding_radius)) {
    status = status::no_size;
    return;
  }
  margin = wanted_margin;
  status |= limit_margin(margin, std::min(place.size_u(), place.size_v()));
  frame = local_frame(place, pose);
  if (is_far(frame.origin, std::max(place.size_u(), place.size_v()))) {
    status |= status::far;
    return;
  }
  const double reach = bounding_radius + margin;
  const Vec2 at = frame.origin.head<2>();
  if (is_beside(place, at, at, reach)) {
    status |= status::off_edge;
    return;
  }
  is_clear = frame.origin.z() > reach;
}

GridPlace grid_place(double x, double y) {
  constexpr double near = 1e-6;
  const double i = std::floor(x + near), j = std::floor(y + near);
  return {i, j, x - i < near, y - j < near};
}

void Candidates::add(const Candidate& candidate) {
  if (!(candidate.distance <= max_distance_)) return;
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
  shallowest_ = std::size_t(
      std::max_element(begin(), end(),
                       [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; }) -
      begin());
  max_distance_ = std::min(max_distance_, kept_[shallowest_].distance);
}

bool Candidates::use_substitute() {
  if (overlaps_ || !(has_fallback_ || has_last_resort_)) return false;
  add(has_fallback_ ? fallback_ : last_resort_);
  return true;
}

std::size_t Candidates::select(Selected& selected) {
  std::sort(kept_.begin(), kept_.begin() + std::ptrdiff_t(count_),
            [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  std::size_t count = 0;
  std::array<bool, capacity> used{};
  const auto take = [&](std::size_t k) {
    used[k] = true;
    selected[count++] = &kept_[k];
  };
  // First the deepest of each distinct direction; two slots stay free for support.
  const double cos_angle = elementary::cos(min_angle);
  for (std::size_t k = 0; k < count_ && count + 2 < selected.size(); ++k) {
    const bool differs =
        std::all_of(selected.begin(), selected.begin() + std::ptrdiff_t(count),
                    [&](const Candidate* c) { return c->normal.dot(kept_[k].normal) < cos_angle; });
    if (count == 0 || differs) take(k);
  }
  // Then the point farthest from those selected, minus the weighted gap, again and again.
  while (count > 0 && count < selected.size()) {
    std::size_t best = count_;
    double best_score = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      if (used[k]) continue;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t n = 0; n < count; ++n)
        nearest = std::min(nearest, (selected[n]->point - kept_[k].point).norm());
      const double score = nearest - gap_weight * (kept_[k].distance - selected[0]->distance);
      // Skip duplicates.
      if (nearest < 1e-9 || (best < count_ && score <= best_score)) continue;
      best = k;
      best_score = score;
    }
    if (best == count_) break;
    take(best);
  }
  std::sort(selected.begin(), selected.begin() + std::ptrdiff_t(count),
            [](const Candidate* a, const Candidate* b) { return a->distance < b->distance; });
  return count;
}

void Candidates::select(const surface::Surface& surface, ContactSet& set) {
  if (overflowed_) set.status |= status::limit;
  Selected selected;
  const std::size_t count = select(selected);
  for (std::size_t k = 0; k < count; ++k) set.points[set.count++] = to_contact_point(surface, *selected[k]);
}

}  // namespace intaglio::contact
