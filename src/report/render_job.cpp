#include "report/render_job.h"

#include <pthread.h>

#include <fmt/format.h>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <queue>
#include <thread>

#include "core/file.h"
#include "core/output_files.h"
#include "core/progress.h"
#include "render/renderer.h"
#include "report/report.h"
#include "scene/picture.h"
#include "session/recording.h"
#include "session/simulation.h"
#include "session/video.h"
#include "sound/audio/wav.h"

namespace intaglio::report {

namespace fs = std::filesystem;

namespace {

// Draws and encodes snapshots, on a thread of its own or on the caller's.
class FrameEncoder {
 public:
  FrameEncoder(scene::ScenePicture picture, render::Renderer& renderer, session::VideoWriter& video,
               bool own_thread, std::int64_t frames)
      : picture_(std::move(picture)),
        renderer_(renderer),
        video_(video),
        key_every_(std::max<std::int64_t>(1, frames / 6)) {
    pthread_getcpuclockid(pthread_self(), &simulation_clock_);
    if (own_thread) thread_ = std::thread([this] { work(); });
  }
  ~FrameEncoder() { stop(); }

  // Blocks while 8 snapshots are queued. Returns errors of earlier frames.
  Result<void> add(session::Snapshot snapshot) {
    if (!thread_.joinable()) return draw(snapshot);
    std::unique_lock lock(mutex_);
    not_full_.wait(lock, [&] { return queue_.size() < 8 || error_; });
    if (error_) return tl::unexpected(*error_);
    queue_.push(std::move(snapshot));
    not_empty_.notify_one();
    return {};
  }
  Result<void> finish() {
    stop();
    if (error_) return tl::unexpected(*error_);
    return {};
  }
  session::CostMeter& cost() { return cost_; }
  std::vector<session::KeyFrame>& key_frames() { return key_frames_; }

 private:
  void stop() {
    if (!thread_.joinable()) return;
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    not_empty_.notify_one();
    thread_.join();
  }

  void work() {
    while (true) {
      session::Snapshot snapshot;
      {
        std::unique_lock lock(mutex_);
        not_empty_.wait(lock, [&] { return !queue_.empty() || closed_; });
        if (queue_.empty()) return;
        snapshot = std::move(queue_.front());
        queue_.pop();
      }
      not_full_.notify_one();
      auto drawn = draw(snapshot);
      if (drawn) continue;
      const std::lock_guard lock(mutex_);
      error_ = drawn.error();
      not_full_.notify_one();
      return;
    }
  }

  Result<void> draw(const session::Snapshot& snapshot) {
    const std::int64_t start = drawing_cpu_ns();
    const Image8 image = renderer_.draw(picture_.frame(snapshot.balls, snapshot.bodies, snapshot.pen_tip));
    cost_.add(drawing_cpu_ns() - start);
    if (frames_++ % key_every_ == key_every_ / 2 && key_frames_.size() < 6)
      key_frames_.push_back({snapshot.time, image});
    return video_.add(image);
  }

  // Software GL has threads of its own, so count the process's CPU time minus the simulation thread's.
  std::int64_t drawing_cpu_ns() const {
    return session::process_cpu_ns() - (thread_.joinable() ? session::cpu_ns(simulation_clock_) : 0);
  }

  scene::ScenePicture picture_;
  render::Renderer& renderer_;
  session::VideoWriter& video_;
  clockid_t simulation_clock_{};
  std::int64_t key_every_, frames_ = 0;
  session::CostMeter cost_;
  std::vector<session::KeyFrame> key_frames_;
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable not_empty_, not_full_;
  std::queue<session::Snapshot> queue_;
  bool closed_ = false;
  std::optional<Error> error_;
};

}  // namespace

Result<session::Recording> render(const scene::Scene& scene, const RenderJob& job) {
  const auto start = std::chrono::steady_clock::now();
  const auto output = [&](const char* extension) {
    return fs::path(job.output).replace_extension(extension);
  };
  if (const auto ffmpeg = session::find_ffmpeg(); !ffmpeg) return tl::unexpected(ffmpeg.error());
  if (auto named = check_extension(job.output, ".mp4", "an MP4"); !named)
    return tl::unexpected(named.error());
  for (const char* extension : {".mp4", ".wav", ".html", ".events.csv", ".servo.csv"}) {
    if (auto writable = check_writable(output(extension)); !writable) return tl::unexpected(writable.error());
  }

  const auto surface = scene::make_surface(scene);
  if (!surface) return tl::unexpected(surface.error());
  Progress progress("render", job.quiet);
  progress.update(0, "modal analysis");
  auto simulation = session::Simulation::create(scene, *surface);
  if (!simulation) return tl::unexpected(simulation.error());
  auto renderer = scene::make_renderer(scene, *surface);
  if (!renderer) return tl::unexpected(renderer.error());
  OutputFiles files;
  auto video = session::VideoWriter::create(files, job.output,
                                            {scene.video.width, scene.video.height, scene.video.fps});
  if (!video) return tl::unexpected(video.error());

  const auto frames = std::int64_t(scene.duration * scene.video.fps + 1e-9);
  FrameEncoder pictures({scene, *surface}, **renderer, **video, job.threads > 1, frames);
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    const session::Snapshot snapshot = (*simulation)->advance_to_frame(frame);
    progress.update(double(frame) / double(frames),
                    fmt::format("{:.1f} of {:.1f} s", snapshot.time, scene.duration));
    if (auto added = pictures.add(snapshot); !added) return tl::unexpected(added.error());
  }
  (*simulation)->finish();
  if (auto drawn = pictures.finish(); !drawn) return tl::unexpected(drawn.error());

  session::Recording recording = std::move((*simulation)->recording());
  const auto wav =
      sound::add_wav(files, output(".wav"), recording.stereo, recording.sample_rate, {.channels = 2});
  if (!wav) return tl::unexpected(wav.error());
  const auto mp4 = (*video)->finish(*wav);
  if (!mp4) return tl::unexpected(mp4.error());
  recording.notes = surface->notes;
  recording.key_frames = std::move(pictures.key_frames());
  recording.costs.push_back(pictures.cost().summarise(
      {"picture", fmt::format("{}x{} frame", scene.video.width, scene.video.height), 1.0 / scene.video.fps}));
  recording.peak_memory_bytes = session::peak_memory_bytes();
  recording.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto bytes = read_file(*mp4);
  if (!bytes) return tl::unexpected(bytes.error());
  for (const auto& [extension, text] : {std::pair{".events.csv", session::events_csv(recording)},
                                        {".servo.csv", session::servo_csv(recording)},
                                        {".html", report_html(recording, *bytes)}}) {
    if (auto written = files.write(output(extension), text); !written) return tl::unexpected(written.error());
  }
  if (auto committed = files.commit(); !committed) return tl::unexpected(committed.error());
  progress.update(1, fmt::format("{:.1f} of {:.1f} s", scene.duration, scene.duration));
  return recording;
}

}  // namespace intaglio::report
