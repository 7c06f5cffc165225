#include "report/render_job.h"

#include <pthread.h>

#include <fmt/format.h>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <queue>
#include <thread>

#include "core/file.h"
#include "core/file_stream.h"
#include "core/output_files.h"
#include "core/progress.h"
#include "render/renderer.h"
#include "report/digest.h"
#include "report/report.h"
#include "scene/picture.h"
#include "session/result_files.h"
#include "session/simulation.h"
#include "session/video.h"

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

// Errors that can be known before the work begins.
Result<void> check_outputs(const fs::path& output) {
  if (const auto ffmpeg = session::find_ffmpeg(); !ffmpeg) return tl::unexpected(ffmpeg.error());
  if (auto named = check_extension(output, ".mp4", "an MP4"); !named) return named;
  for (const char* extension : {".mp4", ".wav", ".html", ".events.csv", ".servo.csv"}) {
    auto writable = check_writable(fs::path(output).replace_extension(extension));
    if (!writable) return writable;
  }
  return {};
}

// A scene that is simulated, drawn and written at once.
class Rendering {
 public:
  Rendering(const scene::Scene& scene, const RenderJob& job)
      : scene_(scene),
        job_(job),
        progress_("render", job.quiet),
        frames_(std::int64_t(scene.duration * scene.video.fps + 1e-9)) {}

  Result<session::Run> run();

 private:
  Result<void> prepare();
  Result<void> simulate(session::ResultFiles& results, FrameEncoder& pictures);
  Result<void> write_page(const Digest& digest, const fs::path& mp4);

  const scene::Scene& scene_;
  const RenderJob& job_;
  Progress progress_;
  std::int64_t frames_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  OutputFiles files_;  // declared before those that write to it
  scene::SceneSurface surface_;
  std::unique_ptr<session::Simulation> simulation_;
  std::unique_ptr<render::Renderer> renderer_;
  std::unique_ptr<session::VideoWriter> video_;
};

Result<void> Rendering::prepare() {
  auto surface = scene::make_surface(scene_);
  if (!surface) return tl::unexpected(surface.error());
  surface_ = std::move(*surface);
  scene::VoiceOptions voices;
  voices.progress = [&](int done, int all) {
    progress_.update(0, fmt::format("modal analysis {} of {}", done + 1, all));
  };
  auto simulation = session::Simulation::create(scene_, surface_, voices);
  if (!simulation) return tl::unexpected(simulation.error());
  simulation_ = std::move(*simulation);
  auto renderer = scene::make_renderer(scene_, surface_);
  if (!renderer) return tl::unexpected(renderer.error());
  renderer_ = std::move(*renderer);
  auto video = session::VideoWriter::create(
      files_, job_.output,
      {.width = scene_.video.width, .height = scene_.video.height, .fps = scene_.video.fps});
  if (!video) return tl::unexpected(video.error());
  video_ = std::move(*video);
  return {};
}

Result<void> Rendering::simulate(session::ResultFiles& results, FrameEncoder& pictures) {
  for (std::int64_t frame = 0; frame < frames_; ++frame) {
    if (job_.stop != nullptr && job_.stop->load())
      return fail(job_.output.string(), "was stopped: nothing was written");
    const session::Snapshot snapshot = simulation_->advance_to_frame(frame);
    progress_.update(double(frame) / double(frames_),
                     fmt::format("{:.1f} of {:.1f} s", snapshot.time, scene_.duration));
    if (auto added = pictures.add(snapshot); !added) return added;
    if (auto written = results.check(); !written) return written;
  }
  simulation_->finish();
  if (auto drawn = pictures.finish(); !drawn) return drawn;
  return results.finish();
}

Result<void> Rendering::write_page(const Digest& digest, const fs::path& mp4) {
  auto page = FileStream::create(files_, fs::path(job_.output).replace_extension(".html"));
  if (!page) return tl::unexpected(page.error());
  const PageVideo video{mp4, job_.output.filename().string()};
  auto written = write_report(digest, video, [&](std::string_view text) { page->write(text); });
  return written ? page->finish() : written;
}

Result<session::Run> Rendering::run() {
  if (auto prepared = prepare(); !prepared) return tl::unexpected(prepared.error());
  session::Run& run = simulation_->run();
  run.notes = surface_.notes;
  const auto results = session::ResultFiles::create(files_, job_.output, run);
  if (!results) return tl::unexpected(results.error());
  Digest digest(run);
  simulation_->add_observer(**results);
  simulation_->add_observer(digest);
  FrameEncoder pictures({scene_, surface_}, *renderer_, *video_, job_.threads > 1, frames_);
  if (auto simulated = simulate(**results, pictures); !simulated) return tl::unexpected(simulated.error());
  digest.finish();
  const auto mp4 = video_->finish((*results)->wav());
  if (!mp4) return tl::unexpected(mp4.error());
  run.key_frames = std::move(pictures.key_frames());
  run.costs.push_back(pictures.cost().summarise(
      {"picture", fmt::format("{}x{} frame", scene_.video.width, scene_.video.height),
       1.0 / scene_.video.fps}));
  run.peak_memory_bytes = session::peak_memory_bytes();
  run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (auto page = write_page(digest, *mp4); !page) return tl::unexpected(page.error());
  if (auto committed = files_.commit(); !committed) return tl::unexpected(committed.error());
  progress_.update(1, fmt::format("{:.1f} of {:.1f} s", scene_.duration, scene_.duration));
  return std::move(run);
}

}  // namespace

Result<session::Run> render(const scene::Scene& scene, const RenderJob& job) {
  if (auto checked = check_outputs(job.output); !checked) return tl::unexpected(checked.error());
  return Rendering(scene, job).run();
}

}  // namespace intaglio::report
