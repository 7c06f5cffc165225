#include "sound/api.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "sound/model_file.h"
#include "sound/synthesizer.h"
#include "surface/api.h"

namespace intaglio {

Result<ModalModel> ModalModel::load(const std::filesystem::path& path) {
  return sound::read_model(path).map([](sound::ModalModel model) { return handle_of(std::move(model)); });
}
Result<void> ModalModel::save(const std::filesystem::path& path) const {
  return sound::write_model(path, *impl_->model);
}

const std::string& ModalModel::name() const {
  return impl_->model->name;
}
const Material& ModalModel::material() const {
  return impl_->model->material;
}
double ModalModel::mass() const {
  return impl_->model->mass;
}
int ModalModel::modes() const {
  return impl_->model->modes();
}

namespace {

bool has_mode(const sound::ModalModel& model, int mode) {
  return mode >= 0 && mode < model.modes();
}

}  // namespace

double ModalModel::frequency(int mode) const {
  if (!has_mode(*impl_->model, mode)) return 0;
  const double omega = impl_->model->angular_frequency[std::size_t(mode)],
               damping = impl_->model->damping[std::size_t(mode)];
  return std::sqrt(omega * omega - damping * damping) / (2 * std::numbers::pi);
}
double ModalModel::decay_time(int mode) const {
  if (!has_mode(*impl_->model, mode)) return 0;
  return std::log(1000.0) / impl_->model->damping[std::size_t(mode)];
}
double ModalModel::gain(int mode, const Vec3& point, const Vec3& direction) const {
  if (!has_mode(*impl_->model, mode)) return 0;
  std::vector<float> gains(std::size_t(mode) + 1);
  impl_->model->gains(point, direction, gains);
  return double(gains.back());
}
ModalModel ModalModel::scaled(double scale) const {
  return handle_of(sound::scaled(*impl_->model, scale));
}

namespace {

sound::SynthesizerOptions synthesizer_options(const SynthesizerOptions& from) {
  sound::SynthesizerOptions options;
  options.sample_rate = from.sample_rate;
  options.seed = from.seed;
  switch (from.meso) {
    case MesoSource::engine_impulses:
      options.meso = sound::MesoSource::engine_impulses;
      break;
    case MesoSource::normal_map:
      options.meso = sound::MesoSource::normal_map;
      break;
    case MesoSource::height:
      options.meso = sound::MesoSource::height;
      break;
  }
  options.micro_level = from.micro_level;
  options.dead_band = from.dead_band;
  options.max_pulses = from.max_pulses;
  options.max_pairs = from.max_pairs;
  options.max_modes = from.max_modes;
  return options;
}

Result<std::vector<sound::SoundBody>> sound_bodies(const SynthesizerOptions& options,
                                                   const std::vector<SoundBody>& bodies) {
  if (!(options.sample_rate > 0) || !std::isfinite(options.sample_rate))
    return fail("SynthesizerOptions::sample_rate", "is not above 0 Hz", "44100 or 48000 are usual");
  std::vector<sound::SoundBody> out;
  for (const SoundBody& from : bodies) {
    sound::SoundBody body;
    body.id = from.id;
    if (from.model) body.model = from.model->impl().model;
    if (from.material) {
      const auto material = from.material->material();
      if (!material) return tl::unexpected(material.error());
      body.material = *material;
    }
    body.mass = from.mass;
    body.is_fixed = from.is_fixed;
    body.radius_of_curvature = from.radius_of_curvature;
    body.rest_pose = from.rest_pose;
    for (const Surface& surface : from.surfaces) body.textures.push_back(surface.impl().surface);
    out.push_back(std::move(body));
  }
  return out;
}

SynthesizerStatus status_of(const sound::SynthesizerStatus& from) {
  return {from.dropped_pulses, from.truncated_paths, from.late_events,
          from.unknown_bodies, from.stolen_groups,   from.dropped_pairs};
}

}  // namespace

struct Synthesizer::Impl {
  sound::Synthesizer synthesizer;
};

Synthesizer::Synthesizer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Synthesizer::Synthesizer(Synthesizer&&) noexcept = default;
Synthesizer& Synthesizer::operator=(Synthesizer&&) noexcept = default;
Synthesizer::~Synthesizer() = default;

Result<Synthesizer> Synthesizer::create(const SynthesizerOptions& options,
                                        const std::vector<SoundBody>& bodies) {
  auto made = sound_bodies(options, bodies);
  if (!made) return tl::unexpected(made.error());
  return Synthesizer(
      std::make_unique<Impl>(Impl{sound::Synthesizer(synthesizer_options(options), std::move(*made))}));
}

void Synthesizer::push(const ContactEvent& event) {
  impl_->synthesizer.push(event);
}
void Synthesizer::render(std::span<float> samples) {
  impl_->synthesizer.render(samples);
}
void Synthesizer::render_stereo(std::span<float> stereo) {
  impl_->synthesizer.render_stereo(stereo);
}
void Synthesizer::set_listener(const Listener& listener) {
  impl_->synthesizer.set_listener({listener.position, listener.right});
}
double Synthesizer::time() const {
  return impl_->synthesizer.time();
}
bool Synthesizer::is_silent() const {
  return impl_->synthesizer.is_silent();
}
SynthesizerStatus Synthesizer::status() const {
  return status_of(impl_->synthesizer.status());
}

void to_full_scale(std::span<const float> pascals, std::span<float> out, double gain_db) {
  sound::to_full_scale(pascals, out, {gain_db});
}

LiveSound::LiveSound(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LiveSound::LiveSound(LiveSound&&) noexcept = default;
LiveSound& LiveSound::operator=(LiveSound&&) noexcept = default;
LiveSound::~LiveSound() = default;

Result<LiveSound> LiveSound::create(const SynthesizerOptions& synthesizer,
                                    const std::vector<SoundBody>& bodies, const LiveSoundOptions& options) {
  auto made = sound_bodies(synthesizer, bodies);
  if (!made) return tl::unexpected(made.error());
  return LiveSound(std::unique_ptr<Impl>(new Impl{sound::LiveSound(
      synthesizer_options(synthesizer), std::move(*made), {options.delay, options.gain_db, options.queue})}));
}

void LiveSound::push(const ContactEvent& event) {
  impl_->sound.push(event);
}
void LiveSound::advance(double time) {
  impl_->sound.advance(time);
}
void LiveSound::set_listener(const Listener& listener) {
  impl_->sound.set_listener({listener.position, listener.right});
}
void LiveSound::set_gain_db(double gain_db) {
  impl_->sound.set_gain_db(gain_db);
}
LiveSoundStatus LiveSound::status() {
  const sound::LiveSoundStatus from = impl_->sound.status();
  return {from.events, from.dropped_events, from.stalls,
          from.delay,  from.worst_latency,  status_of(from.synthesizer)};
}
void LiveSound::render(std::span<float> stereo) noexcept {
  impl_->sound.render(stereo);
}

}  // namespace intaglio
