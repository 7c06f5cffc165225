#include "report/onsets.h"

#include <algorithm>
#include <cmath>

namespace intaglio::report {

OnsetFinder::OnsetFinder(double sample_rate)
    : sample_rate_(sample_rate), slot_samples_(sample_rate >= 1000 ? std::size_t(sample_rate / 1000) : 0) {}

void OnsetFinder::add(float sample) {
  if (slot_samples_ == 0) return;
  const float difference = sample - last_;
  last_ = sample;
  if (std::isfinite(difference)) energy_ += double(difference) * double(difference);
  if (++in_slot_ == slot_samples_) close_slot();
}

void OnsetFinder::close_slot() {
  loudest_ = std::max(loudest_, energy_);
  const Rise rise{double(slot_ * slot_samples_) / sample_rate_, slot_, energy_};
  const double most_before = *std::max_element(before_.begin(), before_.end());
  if (energy_ > 0 && energy_ >= 4 * most_before && is_loud(rise))
    rises_.add(rise, [this](const Rise& kept) { return is_loud(kept); });
  before_[slot_++ % rest] = energy_;
  energy_ = 0;
  in_slot_ = 0;
}

std::vector<double> OnsetFinder::onsets(std::size_t stride) const {
  TimeSample<Rise> sample = rises_;
  sample.thin(stride);
  std::vector<double> out;
  std::size_t next = 0;  // the first slot after the rest
  for (const Rise& rise : sample.kept()) {
    if (rise.slot < next || !is_loud(rise)) continue;
    out.push_back(rise.time);
    next = rise.slot + rest + 1;
  }
  return out;
}

}  // namespace intaglio::report
