#include "report/contact_digest.h"

#include <algorithm>
#include <cmath>

namespace intaglio::report {

namespace {

constexpr double impact_seconds = 0.010;
constexpr double drawn_fraction = 0.02;  // of the largest impulse

}  // namespace

std::vector<Impact> strongest(const std::vector<Impact>& impacts, std::size_t count, double apart) {
  std::vector<Impact> kept;
  for (const Impact& impact : impacts) {
    if (kept.size() == count || impact.impulse < 0.1 * impacts.front().impulse) break;
    const auto near = [&](const Impact& other) { return std::abs(other.time - impact.time) < apart; };
    if (std::none_of(kept.begin(), kept.end(), near)) kept.push_back(impact);
  }
  std::stable_sort(kept.begin(), kept.end(),
                   [](const Impact& a, const Impact& b) { return a.time < b.time; });
  return kept;
}

void ContactDigest::add(const ContactEvent& event) {
  const std::size_t rank = count_++;
  touched_.insert({event.body, event.other});
  touches_.add(event);
  const double impulse = event.impulse.norm();
  if (event.body == pen_) return;
  if (std::isfinite(impulse) && impulse > drawn_fraction * largest_impulse_)
    hits_.add(impulse, rank, {event.time, event.body, event.point, impulse});
  if (std::isfinite(impulse)) largest_impulse_ = std::max(largest_impulse_, impulse);
  if (event.body != floor_body && event.phase != ContactPhase::end && std::isfinite(event.time))
    add_to_impact(event, std::isfinite(impulse) ? impulse : 0);
}

void ContactDigest::add_to_impact(const ContactEvent& event, double impulse) {
  const auto open = open_.find(event.body);
  if (open != open_.end() && event.time - open->second.impact.time <= impact_seconds) {
    open->second.impact.impulse += impulse;
  } else if (event.phase == ContactPhase::begin) {
    if (open != open_.end())
      impacts_.add(open->second.impact.impulse, open->second.rank, open->second.impact);
    open_.insert_or_assign(event.body, OpenImpact{{event.time, event.body, impulse}, count_});
  }
}

void ContactDigest::finish() {
  touches_.finish();
  for (const auto& [body, last] : open_) impacts_.add(last.impact.impulse, last.rank, last.impact);
  open_.clear();
}

std::vector<Hit> ContactDigest::hits() const {
  std::vector<Hit> hits = hits_.sorted();
  std::erase_if(hits, [this](const Hit& hit) { return hit.impulse <= drawn_fraction * largest_impulse_; });
  return hits;
}

}  // namespace intaglio::report
