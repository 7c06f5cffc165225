#include "session/heard_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace intaglio::session {

HeardContacts::HeardContacts(const scene::Scene& scene, const scene::SceneSurface& surface,
                             const HeardOptions& options)
    : lead_(options.lead), pen_(scene.pen ? scene.pen_id() : 0) {
  const std::array sounds = {scene::Cue::pen_sound, scene::Cue::ball_sound};
  const std::array exists = {scene.pen.has_value(), !scene.balls.empty() || !scene.bodies.empty()};
  std::array<std::size_t, 2> samples{};
  std::optional<std::size_t> common;
  for (std::size_t k = 0; k < 2; ++k) {
    const scene::CueSettings& cue = scene.cues[sounds[k]];
    samples[k] = std::size_t(std::lround(cue.delay * options.sample_rate));
    if (exists[k] && cue.on) common = std::min(common.value_or(samples[k]), samples[k]);
  }
  if (options.delays_output) common_ = common.value_or(0);
  const Vec2 size = surface.surface->placement().size();
  for (std::size_t k = 0; k < 2; ++k) {
    const scene::CueSettings& cue = scene.cues[sounds[k]];
    Change& change = changes_[k];
    change.on = cue.on;
    change.delay = double(samples[k] - std::min(samples[k], common_)) / options.sample_rate;
    change.uv_shift = cue.shift.cwiseQuotient(size);
    change.texture = scene::heard_texture(surface, sounds[k]);
    change.is_true = cue.on && change.delay == 0 && change.texture == 0;
  }
}

void HeardContacts::add(const ContactEvent& event, const Sink& sink) {
  Change& change = changes_[pen_ != 0 && event.body == pen_ ? 0 : 1];
  if (change.is_true) return sink(event);
  if (!change.on) return;
  ContactEvent heard = event;
  if (event.other == floor_body && event.texture >= 0) {
    heard.texture = change.texture;
    heard.uv -= change.uv_shift;
  }
  if (change.delay == 0) return sink(heard);
  heard.time += change.delay;
  change.waiting.push_back(heard);
}

void HeardContacts::release(double now, const Sink& sink) {
  for (Change& change : changes_) {
    for (; !change.waiting.empty() && change.waiting.front().time <= now + lead_; change.waiting.pop_front())
      sink(change.waiting.front());
  }
}

void DelayLine::pass(std::span<float> stereo) {
  if (kept_.empty()) return;
  for (float& sample : stereo) {
    std::swap(sample, kept_[next_]);
    next_ = next_ + 1 == kept_.size() ? 0 : next_ + 1;
  }
}

}  // namespace intaglio::session
