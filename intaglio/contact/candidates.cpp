#include "intaglio/contact/candidates.h"

#include <algorithm>

#include "intaglio/core/elementary.h"

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

}  // namespace intaglio::contact
