#include "window/application.h"

#include <SDL2/SDL.h>

#include <fmt/format.h>
#include <chrono>
#include <cmath>
#include <ctime>
#include <deque>
#include <future>

#include "core/file.h"
#include "window/input.h"
#include "window/panels.h"
#include "window/recorder.h"
#include "window/script.h"
#include "window/sdl_window.h"
#include "window/stage.h"

namespace intaglio::window {

namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr double frame_deadline = 1.0 / 30, recorded_rate = 30;

double since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

class Application {
 public:
  Application(const RunOptions& options, SdlWindow& window, Settings settings, SteadyClock::time_point start)
      : options_(options),
        window_(window),
        settings_(std::move(settings)),
        panels_(settings_.interface_scale > 0 ? settings_.interface_scale : window.size().scale,
                window.size().density()),
        input_(render::Camera{}),
        script_(options.script),
        start_(start) {
    panel_data_.driver = window.description();
    report_.driver = panel_data_.driver;
  }

  Result<RunReport> run();
  const Settings& settings() const { return settings_; }

 private:
  double scale() const {
    return settings_.interface_scale > 0 ? settings_.interface_scale : window_.size().scale;
  }
  void post_message(const std::string& message);
  Result<Vec2> body_position_in_window(std::size_t body);
  void begin_session();
  void draw(double seconds);
  void draw_panels_over(double seconds);
  void do_actions(const PanelActions& actions);
  void adapt_resolution();
  void collect_audio();
  void toggle_recording();
  void record();
  void stop_recording();
  void report_recovered();
  void screenshot(const std::string& file);
  std::filesystem::path new_file(const char* extension) const;
  void report_gl_errors();
  void finish_report();

  const RunOptions& options_;
  SdlWindow& window_;
  Settings settings_;
  PanelHost panels_;
  Stage stage_;
  InputController input_;
  Gamepad gamepad_;
  ScriptPlayer script_;
  PanelData panel_data_;
  RunReport report_;
  FrameTimes times_;
  std::unique_ptr<Recorder> recorder_;
  std::future<std::vector<Result<session::RecoveredVideo>>> recovery_;
  SteadyClock::time_point start_, recording_since_, message_time_;
  std::vector<float> audio_block_;
  std::string screenshot_file_;
  bool wants_screenshot_ = false;
  double picture_scale_ = 1, next_adaptation_ = 0;
  bool has_picture_ = false;
};

void Application::post_message(const std::string& message) {
  if (message.empty() || (!panel_data_.messages.empty() && panel_data_.messages.back() == message)) return;
  panel_data_.messages.push_back(message);
  message_time_ = SteadyClock::now();
  if (panel_data_.messages.size() > 20) panel_data_.messages.pop_front();
  report_.messages.push_back(message);
}

Result<RunReport> Application::run() {
  auto opened = stage_.open(options_.audio, options_.device);
  if (!opened) return tl::unexpected(opened.error());
  post_message(*opened);
  panel_data_.audio_device = "audio: " + stage_.audio()->name();
  report_.audio_device = stage_.audio()->name();
  stage_.set_scene_file(options_.scene_file);
  stage_.set_shaders(options_.shaders);
  stage_.request_scene(options_.scene, settings_, false);
  recovery_ = std::async(std::launch::async, session::recover_videos, options_.record_to);
  auto before = SteadyClock::now();
  while (!script_.is_finished()) {
    if (options_.interrupted != nullptr && options_.interrupted->load()) break;
    InputCommands commands;
    if (has_picture_)
      script_.play(window_, settings_, report_.messages,
                   [this](std::size_t body) { return body_position_in_window(body); });
    SDL_Event event;
    while (SDL_PollEvent(&event) != 0) {
      const bool captured = panels_.handle_event(event);
      gamepad_.handle_event(event);
      input_.handle_event(event, captured, settings_, commands);
    }
    if (commands.quit) break;
    for (const std::string& file : commands.dropped_files)
      if (auto dropped = stage_.drop(file, settings_); !dropped) post_message(dropped.error().message());
    if (!script_.screenshot().empty()) {
      wants_screenshot_ = true;
      screenshot_file_ = script_.screenshot();
    } else if (commands.screenshot) {
      wants_screenshot_ = true;
      screenshot_file_.clear();
    }
    if (commands.record) toggle_recording();
    std::string message = stage_.update(settings_, since(start_));
    if (stage_.take_loaded(message)) begin_session();
    post_message(message);
    if (recovery_.valid() && recovery_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
      report_recovered();
    const auto now = SteadyClock::now();
    const double seconds = std::chrono::duration<double>(now - before).count();
    before = now;
    draw(seconds);
    const double took = since(now);
    if (has_picture_) times_.add(seconds);
    panel_data_.frame_seconds = times_.smooth();
    // Without vsync, cap at about 60 frames/s.
    if (took < 0.015) std::this_thread::sleep_for(std::chrono::duration<double>(0.0155 - took));
  }
  if (options_.left) options_.left();
  post_message(stage_.connection_error(settings_));
  finish_report();
  stop_recording();
  if (recovery_.valid()) report_recovered();
  report_.was_baking = stage_.is_baking();
  return report_;
}

// A body's projected centre, in fractions of the window; 1 is the first ball, 0 the first visible draggable
// body.
Result<Vec2> Application::body_position_in_window(std::size_t body) {
  session::LiveSession* session = stage_.session();
  if (session == nullptr) return fail("", "there is no scene yet");
  const WindowSize size = window_.size();
  const Projection projection(input_.camera().camera(), double(size.width) / size.height);
  const session::LiveState& state = session->state();
  if (body > state.bodies)
    return fail("", fmt::format("there is no body {}", body),
                fmt::format("point takes 0 (the first visible body) to {}", state.bodies));
  for (std::size_t k = std::max<std::size_t>(body, 1);
       k <= (body == 0 ? state.bodies : std::min(body, state.bodies)); ++k) {
    const auto place = projection.project(state.pose[k - 1].position);
    const bool is_inside = place && (place->array() > 0.02).all() && (place->array() < 0.98).all();
    if (is_inside && (body != 0 || session->is_free(BodyId(k)))) return *place;
  }
  return fail("",
              body == 0 ? "no draggable body is visible" : fmt::format("body {} is outside the view", body));
}

void Application::begin_session() {
  const scene::Scene& scene = stage_.session()->scene();
  render::Camera camera;
  camera.eye = scene.camera.eye;
  camera.target = scene.camera.target;
  camera.fov_y_degrees = scene.camera.vertical_fov;
  input_.set_camera(camera);
  panel_data_.title = scene.title;
  window_.set_title(fmt::format("{} - Intaglio", scene.title));
}

void Application::draw(double seconds) {
  const WindowSize size = window_.size();
  const double aspect = double(size.width) / size.height;
  input_.set_window(size.window_width, size.window_height);
  if (session::LiveSession* session = stage_.session()) {
    input_.set_gamepad(gamepad_.left(), gamepad_.right(), gamepad_.shoulders());
    input_.update(seconds, settings_, *session, aspect);
    session->set_gain_db(settings_.mute ? -300 : session->scene().sound.gain_db + settings_.volume);
    const render::Camera& camera = input_.camera().camera();
    session->set_listener({camera.eye, Projection(camera, aspect).right});
    if (settings_.rumble) gamepad_.rumble(session->state());
    post_message(session->take_message());
    if (auto drawn = stage_.draw(camera, settings_, size.width, size.height, picture_scale_); !drawn)
      post_message(drawn.error().message());
    collect_audio();
    record();
    if (!has_picture_) report_.start_seconds = since(start_);
    has_picture_ = true;
  } else if (!stage_.is_loading()) {
    script_.stop();  // the first scene failed to load: nothing to show
  }
  draw_panels_over(seconds);
  if (std::exchange(wants_screenshot_, false)) screenshot(screenshot_file_);
  report_gl_errors();
  window_.swap();
  adapt_resolution();
}

void Application::draw_panels_over(double seconds) {
  const WindowSize size = window_.size();
  panels_.begin(size, seconds);
  session::LiveSession* session = stage_.session();
  if (session != nullptr) {
    OverlayData overlay;
    overlay.window = {double(size.window_width), double(size.window_height)};
    overlay.side = session->scene().surface.size.maxCoeff();
    if (const auto& dragging = input_.dragging()) {
      overlay.is_dragging = true;
      overlay.grip = session->state().pose[dragging->body - 1].to_world(dragging->grip);
      overlay.pull_to = input_.controls().pull_to;
    }
    const double aspect = double(size.width) / size.height;
    draw_overlays(settings_, *session, Projection(input_.camera().camera(), aspect), overlay);
  }
  panel_data_.is_loading = stage_.is_loading();
  panel_data_.message_age = since(message_time_);
  panel_data_.picture_scale = picture_scale_;
  panel_data_.gamepad = gamepad_.name();
  panel_data_.audio = stage_.audio()->status();
  panel_data_.recorded = recorder_ ? recorder_->seconds() : -1;
  if (settings_.panels) do_actions(draw_panels(settings_, session, panel_data_, scale()));
  draw_status_line(settings_, panel_data_);
  panels_.draw();
}

void Application::do_actions(const PanelActions& actions) {
  if (actions.reset) input_.reset();
  if (actions.single) input_.single();
  if (actions.home) input_.home();
  if (actions.rearm) stage_.session()->servo().rearm();
  if (actions.record) toggle_recording();
  if (actions.screenshot) {
    wants_screenshot_ = true;
    screenshot_file_.clear();
  }
}

// Lowers the resolution when frames are slow and raises it when there is headroom. The cost is proportional
// to the number of pixels, scale^2, hence the square root. A step up costs at most 1.1^2 * 0.6 = 0.73 of the
// wanted time, so that it cannot cause the next step down.
void Application::adapt_resolution() {
  const double now = since(start_);
  if (!has_picture_ || now < next_adaptation_ || times_.count() < 4) return;
  next_adaptation_ = now + 0.5;
  const double wanted = 1 / std::clamp(settings_.min_frame_rate, 1.0, 60.0);
  if (times_.smooth() > wanted)
    picture_scale_ = std::max(0.25, picture_scale_ * std::max(0.5, std::sqrt(wanted / times_.smooth())));
  if (times_.smooth() < 0.6 * wanted) picture_scale_ = std::min(1.0, 1.1 * picture_scale_);
}

void Application::collect_audio() {
  audio_block_.clear();
  stage_.tap().drain(audio_block_);
  if (recorder_) recorder_->add_audio(audio_block_);
  for (std::size_t k = 0; k + 1 < audio_block_.size(); k += 2)
    panel_data_.scope.push_back(0.5f * (audio_block_[k] + audio_block_[k + 1]));
  constexpr std::size_t scope_samples = 2048, force_samples = 240;
  if (panel_data_.scope.size() > scope_samples)
    panel_data_.scope.erase(panel_data_.scope.begin(),
                            panel_data_.scope.end() - std::ptrdiff_t(scope_samples));
  panel_data_.force.push_back(float(stage_.session()->state().pen.felt.norm()));
  if (panel_data_.force.size() > force_samples) panel_data_.force.erase(panel_data_.force.begin());
}

std::filesystem::path Application::new_file(const char* extension) const {
  char stamp[32];
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &local);
  return options_.record_to / fmt::format("intaglio-{}{}", stamp, extension);
}

void Application::toggle_recording() {
  if (recorder_) return stop_recording();
  if (!stage_.session()) return;
  const WindowSize size = window_.size();
  auto started = Recorder::start(new_file(".mp4"), size.width, size.height, int(recorded_rate),
                                 stage_.audio()->sample_rate());
  if (!started) return post_message(started.error().message());
  recorder_ = std::move(*started);
  recording_since_ = SteadyClock::now();
  post_message("recording started");
}

void Application::record() {
  if (!recorder_ || !stage_.renderer()) return;
  const double time = since(recording_since_);
  if (!recorder_->is_frame_due(time)) return;
  const auto frame = stage_.renderer()->capture(recorder_->width(), recorder_->height());
  const auto added = frame ? recorder_->add(*frame, time) : tl::unexpected(frame.error());
  if (added) return;
  post_message("recording stopped: " + added.error().message());
  recorder_.reset();
}

void Application::stop_recording() {
  if (!recorder_) return;
  const double seconds = recorder_->seconds();
  const auto file = recorder_->target();
  const auto finished = recorder_->finish();
  recorder_.reset();
  if (!finished) return post_message("could not save the recording: " + finished.error().message());
  report_.files_written.push_back(file.string());
  post_message(fmt::format("recorded {:.1f} s: {}", seconds, file.string()));
}

// Reports the recordings that were recovered from killed windows.
void Application::report_recovered() {
  for (const auto& video : recovery_.get()) {
    if (!video) {
      post_message("could not recover a recording: " + video.error().message());
      continue;
    }
    report_.files_written.push_back(video->file.string());
    post_message(fmt::format("recovered {:.0f} s of a recording: {}", video->seconds, video->file.string()));
  }
}

void Application::screenshot(const std::string& name) {
  const auto file = name.empty() ? new_file(".png") : std::filesystem::path(name);
  const auto written = write_file(file, encode_png(window_.pixels()));
  if (!written) return post_message(written.error().message());
  report_.files_written.push_back(file.string());
  post_message("screenshot: " + file.string());
}

void Application::report_gl_errors() {
  for (int k = 0; k < 8; ++k) {
    const std::string error = gl_error();
    if (error.empty()) return;
    ++report_.gl_errors;
    if (report_.gl_error_names.size() < 8) report_.gl_error_names.push_back(error);
    post_message("OpenGL: " + error);
  }
}

void Application::finish_report() {
  report_.seconds = since(start_);
  report_.bodies_dragged = input_.dragged_count();
  report_.frames = {times_.count(), times_.over(frame_deadline), times_.quantile(0.5), times_.quantile(0.99),
                    times_.quantile(1)};
  session::LiveSession* session = stage_.session();
  const SessionCounts counts = stage_.counts();
  const sound::AudioStatus audio = stage_.audio()->status();
  report_.sound = {audio.buffers, audio.underruns, counts.events, counts.dropped_events, audio.peak_load, 0};
  if (session == nullptr) return;
  const haptics::ServoLoop& servo = session->servo();
  report_.touch = {counts.ticks, counts.skipped_ticks, servo.wake_up().quantile(0.99),
                   servo.compute().quantile(0.99), servo.priority()};
  report_.dynamics = {counts.steps, counts.skipped_steps, session->state().step_seconds};
  if (const auto live = session->sound_status()) report_.sound.delay = live->delay;
}

}  // namespace

Result<void> run(const RunOptions& options, const std::function<void(const RunReport&)>& ended) {
  const auto start = SteadyClock::now();
  Settings settings;
  const std::filesystem::path file = options.keeps_settings && !config_folder().empty()
                                         ? config_folder() / "window.toml"
                                         : std::filesystem::path();
  const auto read = read_settings(file, settings);
  if (options.width) settings.width = *options.width;
  if (options.height) settings.height = *options.height;
  if (options.interface_scale) settings.interface_scale = *options.interface_scale;
  settings.device = options.device;
  auto window = SdlWindow::create("Intaglio", settings.width, settings.height);
  if (!window) return tl::unexpected(window.error());
  Application application(options, **window, settings, start);
  auto report = application.run();
  if (!report) return tl::unexpected(report.error());
  if (!read) report->messages.push_back(read.error().message());
  Settings kept = application.settings();
  const WindowSize size = (*window)->size();
  kept.width = size.window_width;
  kept.height = size.window_height;
  if (options.width || options.height) kept.width = settings.width, kept.height = settings.height;
  if (read)
    if (const auto written = write_settings(file, kept); !written)
      report->messages.push_back(written.error().message());
  ended(*report);
  return {};
}

}  // namespace intaglio::window
