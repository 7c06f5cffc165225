#include "sound/ensemble.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <utility>

#include "sound/modal_bank.h"

namespace intaglio::sound {

namespace {

const Material& material_of(const SoundBody& body) {
  static const Material unknown;
  if (body.material) return *body.material;
  return body.model ? body.model->material : unknown;
}

}  // namespace

Ensemble::Member::Member(SoundBody b, const SynthesizerOptions& options,
                         std::shared_ptr<const MicroNoise> noise)
    : body(std::move(b)), pose(body.rest_pose), source(body.rest_pose.position), micro(std::move(noise)) {
  if (!body.model) return;
  std::vector<Resonator> modes = ModalBank::resonators(*body.model, options.sample_rate);
  model_modes = int(modes.size());
  const Resonator click = acceleration_noise(body.model->area);
  if (!body.is_fixed && body.model->area > 0 && click.damping < std::numbers::pi * options.sample_rate)
    modes.push_back(click);
  bank.emplace_back(modes, options.sample_rate);
}

std::vector<Ensemble::Member> Ensemble::members(std::vector<SoundBody> bodies,
                                                const SynthesizerOptions& options) {
  // Bodies of one roughness share its table of 0.4 MB.
  std::map<std::array<double, 3>, std::shared_ptr<const MicroNoise>> noises;
  std::vector<Member> all;
  for (SoundBody& body : bodies) {
    const MicroRoughness& micro = material_of(body).micro;
    auto& noise = noises[{micro.rms_height, micro.correlation_length, micro.spectral_slope}];
    if (!noise) noise = std::make_shared<const MicroNoise>(micro, options.seed);
    all.emplace_back(std::move(body), options, noise);
  }
  return all;
}

Ensemble::Ensemble(std::vector<SoundBody> bodies, const SynthesizerOptions& options)
    : sample_rate_(options.sample_rate),
      bodies_(members(std::move(bodies), options)),
      pulses_(options.max_pulses, max_padded_modes()),
      max_groups_(std::size_t(options.max_modes) / resonator_lanes),
      scratch_(std::size_t(max_padded_modes())),
      impulses_(std::size_t(options.max_pulses)) {
  reserve_drives(0);
  std::size_t groups = 0;
  for (const Member& member : bodies_) groups += std::size_t(member.padded_modes()) / resonator_lanes;
  sounding_.reserve(groups);
}

const Material& Ensemble::material(int i) const {
  return material_of(body(i));
}

int Ensemble::max_padded_modes() const {
  int most = 0;
  for (const Member& member : bodies_) most = std::max(most, member.padded_modes());
  return most;
}

void Ensemble::reserve_drives(std::size_t count) {
  for (Member& member : bodies_) member.drives.reserve(impulses_.size() + count);
}

int Ensemble::find(BodyId id) const {
  const auto found =
      std::find_if(bodies_.begin(), bodies_.end(), [id](const Member& m) { return m.body.id == id; });
  return found == bodies_.end() ? -1 : int(found - bodies_.begin());
}

void Ensemble::add_gains(int i, const Vec3& point, const Vec3& direction, double weight,
                         std::span<float> out) {
  const Member& member = bodies_[std::size_t(i)];
  if (member.bank.empty()) return;
  const std::span<float> gains = std::span(scratch_).first(std::size_t(member.model_modes));
  member.body.model->gains(member.pose.to_local(point), member.pose.orientation.conjugate() * direction,
                           gains);
  for (std::size_t m = 0; m < gains.size(); ++m) out[m] += float(weight) * gains[m];
  if (member.bank[0].modes() > member.model_modes)
    out[gains.size()] += float(weight * acceleration_gain(member.body.mass));
}

void Ensemble::strike(int i, std::span<const float> gains, const HalfSine& shape, double impulse) {
  if (bodies_[std::size_t(i)].bank.empty() || impulse == 0) return;
  const std::span<float> row = pulses_.add({shape, impulse, i});
  if (!row.empty()) std::copy(gains.begin(), gains.end(), row.begin());
}

void Ensemble::set_touch_point(int i, const Vec3& point) {
  Member& member = bodies_[std::size_t(i)];
  if (member.body.is_fixed) member.source = point;
}

// Ear gains are computed every block_samples and interpolated linearly.
void Ensemble::update_ear_gains(std::int64_t first) {
  if (first % block_samples != 0) return;
  for (Member& member : bodies_) {
    member.ears_from = first == 0 ? ear_gains(listener_, member.source) : member.ears_to;
    member.ears_to = ear_gains(listener_, member.body.is_fixed ? member.source : member.pose.position);
  }
}

void Ensemble::mix(const Member& member, std::int64_t first, std::span<const float> pascals,
                   std::span<float> out) const {
  if (out.size() == pascals.size()) {
    for (std::size_t k = 0; k < pascals.size(); ++k) out[k] += pascals[k];
    return;
  }
  const EarGains &from = member.ears_from, &to = member.ears_to;
  for (std::size_t k = 0; k < pascals.size(); ++k) {
    const float t = float(first % block_samples + std::int64_t(k)) / block_samples;
    out[2 * k] += (from.left + t * (to.left - from.left)) * pascals[k];
    out[2 * k + 1] += (from.right + t * (to.right - from.right)) * pascals[k];
  }
}

void Ensemble::render(std::int64_t first, std::size_t samples, std::span<float> out) {
  update_ear_gains(first);
  const double dt = 1 / sample_rate_, end = double(first + std::int64_t(samples)) * dt;
  const double time = double(first) * dt;
  for (int i = 0; i < pulses_.size(); ++i) {
    const Pulse& pulse = pulses_.pulse(i);
    if (pulse.shape.start >= end) continue;
    const std::span<float> impulse = std::span(impulses_[std::size_t(i)]).first(samples);
    pulse.shape.sample(time, dt, impulse);
    for (float& x : impulse) x *= float(pulse.impulse);
    Member& member = bodies_[std::size_t(pulse.body)];
    member.drives.push_back({pulses_.gains(i).first(std::size_t(member.padded_modes())), impulse, 0});
  }
  for (Member& member : bodies_) {
    if (!member.bank.empty() && !(member.drives.empty() && member.bank[0].is_silent())) {
      std::array<float, block_samples> room{};
      const std::span<float> pascals = std::span(room).first(samples);
      member.bank[0].process(member.drives, pascals);
      mix(member, first, pascals, out);
    }
    member.drives.clear();
  }
  pulses_.remove_ended(end);
}

void Ensemble::sleep_when_silent() {
  for (Member& member : bodies_) {
    if (!member.bank.empty()) member.bank[0].sleep_when_silent();
  }
}

void Ensemble::steal_quietest() {
  std::size_t groups = 0;
  for (const Member& member : bodies_) {
    if (!member.bank.empty()) groups += std::size_t(member.bank[0].sounding_groups());
  }
  if (groups <= max_groups_) return;
  sounding_.clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].bank.empty()) continue;
    const ModalBank& bank = bodies_[i].bank[0];
    for (int g = 0; g < bank.groups(); ++g) {
      if (bank.is_sounding(g)) sounding_.push_back({bank.loudness(g), int(i), g});
    }
  }
  const auto end = sounding_.begin() + std::ptrdiff_t(groups - max_groups_);
  std::nth_element(sounding_.begin(), end, sounding_.end(),
                   [](const Voice& a, const Voice& b) { return a.loudness < b.loudness; });
  for (auto voice = sounding_.begin(); voice != end; ++voice, ++stolen_)
    bodies_[std::size_t(voice->body)].bank[0].fade(voice->group);
}

bool Ensemble::is_silent() const {
  return pulses_.size() == 0 && std::all_of(bodies_.begin(), bodies_.end(), [](const Member& member) {
           return member.bank.empty() || member.bank[0].is_silent();
         });
}

}  // namespace intaglio::sound
