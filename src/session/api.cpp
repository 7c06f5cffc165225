#include "session/api.h"

#include <fmt/format.h>

#include "core/file.h"
#include "core/output_files.h"
#include "render/renderer.h"
#include "scene/api.h"
#include "scene/cost.h"
#include "scene/picture.h"
#include "session/simulation.h"
#include "session/video.h"
#include "sound/audio/wav.h"

namespace intaglio {

namespace {

FrameState frame_of(const session::Snapshot& from) {
  FrameState frame{from.time, from.balls, from.pen_tip};
  frame.bodies.insert(frame.bodies.end(), from.bodies.begin(), from.bodies.end());
  return frame;
}

}  // namespace

Result<Recording> simulate(const Scene& scene, const SimulateOptions& options) {
  const scene::Scene& from = scene.impl().scene;
  if (auto fits = scene::check_cost(from, scene::Use::kept); !fits) return tl::unexpected(fits.error());
  auto surface = scene::make_surface(from);
  if (!surface) return tl::unexpected(surface.error());
  auto simulation = session::Simulation::create(from, *surface);
  if (!simulation) return tl::unexpected(simulation.error());
  session::Recording recording;
  (*simulation)->add_observer(recording);
  std::vector<FrameState> frames;
  const auto count = std::int64_t(from.duration * from.video.fps + 1e-9);
  for (std::int64_t k = 0; k < count; ++k) {
    if (options.stopped != nullptr && options.stopped->load()) return fail(from.name, "stopped");
    frames.push_back(frame_of((*simulation)->advance_to_frame(k)));
    if (options.progress) options.progress(double(k) / double(count));
  }
  (*simulation)->finish();
  static_cast<session::Run&>(recording) = std::move((*simulation)->run());
  recording.notes = surface->notes;
  if (std::string note = scene::cue_note(from.cues); !note.empty())
    recording.notes.push_back(std::move(note));
  if (options.progress) options.progress(1);
  return Recording(std::make_shared<const Recording::Impl>(
      Recording::Impl{scene, std::move(*surface), std::move(recording), std::move(frames)}));
}

const Scene& Recording::scene() const {
  return impl_->scene;
}
double Recording::duration() const {
  return impl_->recording.duration;
}
std::span<const ContactEvent> Recording::events() const {
  return impl_->recording.events;
}
const std::vector<FrameState>& Recording::frames() const {
  return impl_->frames;
}
std::vector<PenSample> Recording::pen() const {
  std::vector<PenSample> samples;
  double time = 0;
  for (const haptics::ServoSample& s : impl_->recording.servo) {
    samples.push_back({time, s.tip, s.force, s.n_s, s.uv, s.touching});
    time = double(samples.size()) / impl_->recording.servo_rate;
  }
  return samples;
}
std::span<const float> Recording::audio() const {
  return impl_->recording.stereo;
}
int Recording::sample_rate() const {
  return impl_->recording.sample_rate;
}
const std::vector<std::string>& Recording::notes() const {
  return impl_->recording.notes;
}
double Recording::momentum_residual() const {
  return impl_->recording.momentum_residual;
}

std::uint64_t Recording::event_hash() const {
  return impl_->recording.event_hash;
}
std::uint64_t Recording::audio_hash() const {
  return impl_->recording.audio_hash;
}
std::string Recording::hash() const {
  return fmt::format("{:016x}-{:016x}", event_hash(), audio_hash());
}

Result<void> Recording::save_audio(const std::filesystem::path& wav) const {
  return sound::write_wav(wav, audio(), sample_rate(), {.channels = 2});
}
Result<void> Recording::save_events(const std::filesystem::path& csv) const {
  return write_file(csv, session::events_csv(impl_->recording));
}

Result<void> Recording::save_video(const std::filesystem::path& mp4,
                                   const std::function<void(double done)>& progress) const {
  const scene::Scene& scene = impl_->scene.impl().scene;
  auto renderer = scene::make_renderer(scene, impl_->surface);
  if (!renderer) return tl::unexpected(renderer.error());
  OutputFiles files;
  auto video =
      session::VideoWriter::create(files, mp4, {scene.video.width, scene.video.height, scene.video.fps});
  if (!video) return tl::unexpected(video.error());
  const scene::ScenePicture picture(scene, impl_->surface);
  const std::size_t balls = scene.balls.size();
  for (std::size_t k = 0; k < impl_->frames.size(); ++k) {
    const FrameState& frame = impl_->frames[k];
    const std::span<const Pose> bodies(frame.bodies);
    const Image8 image =
        (*renderer)->draw(picture.frame(bodies.first(balls), bodies.subspan(balls), frame.pen_tip));
    if (const auto added = (*video)->add(image); !added) return added;
    if (progress) progress(double(k + 1) / double(impl_->frames.size()));
  }
  if (const auto finished = (*video)->finish(audio(), sample_rate()); !finished)
    return tl::unexpected(finished.error());
  return files.commit();
}

}  // namespace intaglio
