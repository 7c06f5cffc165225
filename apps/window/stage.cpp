#include "window/stage.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/file.h"
#include "core/text.h"
#include "haptics/vrpn/client.h"
#include "intaglio/error.h"
#include "intaglio/representation.h"

namespace intaglio::window {

namespace fs = std::filesystem;

void FileWatch::watch(std::vector<fs::path> paths) {
  paths_ = std::move(paths);
  seen_ = times();
}

bool FileWatch::has_changed(double now) {
  if (now < next_) return false;
  next_ = now + 0.5;
  auto found = times();
  if (found == seen_) return false;
  seen_ = std::move(found);
  return true;
}

std::vector<FileWatch::Time> FileWatch::times() const {
  std::vector<Time> found;
  std::error_code ignored;
  for (const fs::path& path : paths_) {
    Time newest = fs::last_write_time(path, ignored);
    if (fs::is_directory(path, ignored))
      for (const auto& entry : fs::directory_iterator(path, ignored))
        newest = std::max(newest, fs::last_write_time(entry.path(), ignored));
    found.push_back(newest);
  }
  return found;
}

namespace {

Loaded load(LoadRequest request) {
  Loaded loaded;
  if (!request.surface) {
    auto surface = scene::make_surface(request.scene);
    if (surface) {
      request.surface = std::move(*surface);
    } else {
      loaded.error = surface.error();
    }
  }
  if (request.surface) {
    auto session =
        session::LiveSession::create(request.scene, *request.surface, request.options, request.device.get());
    if (session) {
      loaded.session = std::move(*session);
    } else {
      loaded.error = session.error();
    }
  }
  loaded.request = std::move(request);
  return loaded;
}

}  // namespace

Loader::Loader() : thread_([this] { work(); }) {}

Loader::~Loader() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Loader::request(LoadRequest request) {
  {
    const std::lock_guard lock(mutex_);
    pending_ = std::move(request);
  }
  wake_.notify_one();
}

std::optional<Loaded> Loader::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

bool Loader::is_busy() {
  const std::lock_guard lock(mutex_);
  return busy_ || pending_ || result_;
}

void Loader::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return pending_ || closed_; });
    if (closed_) return;
    LoadRequest request = std::move(*std::exchange(pending_, std::nullopt));
    busy_ = true;
    lock.unlock();
    Loaded loaded = load(std::move(request));
    lock.lock();
    result_ = std::move(loaded);
    busy_ = false;
  }
}

namespace {

// Whether these settings need another session.
bool needs_new_session(const Settings& a, const Settings& b) {
  const auto key = [](const Settings& s) {
    return std::tuple(s.representation, s.depth, s.stiffness, s.use_paper_method, s.material, s.moves,
                      s.feels, s.hears, s.cues);
  };
  return key(a) != key(b);
}

constexpr std::chrono::seconds answer_timeout(3);

Error no_answer_error(const std::string& device, const haptics::vrpn::VrpnDevice& pen) {
  return {device, "the pen device does not answer: " + pen.last_failure().error.message(),
          "start its VRPN server (for a test: intaglio devices serve), or use the mouse"};
}

}  // namespace

Result<void> PenDevice::open(const std::string& name) {
  if (name.empty()) return {};
  const auto address = haptics::vrpn::parse_address(name);
  if (!address) return tl::unexpected(address.error());
  name_ = name;
  used_ = std::make_shared<haptics::vrpn::VrpnDevice>(*address);
  if (!used_->wait_for_link(answer_timeout)) return tl::unexpected(no_answer_error(name, *used_));
  return {};
}

bool PenDevice::update(const Settings& settings, double now, std::string& message) {
  if (settings.device != name_) {
    name_ = settings.device;
    connecting_.reset();
    if (name_.empty()) {
      used_.reset();
      message = "pen: mouse";
      return true;
    }
    const auto address = haptics::vrpn::parse_address(name_);
    if (!address) {
      message = with_where(settings.device_source, address.error()).message();
      return false;
    }
    connecting_ = std::make_shared<haptics::vrpn::VrpnDevice>(*address);
    connecting_since_ = now;
  }
  if (!connecting_) return false;
  if (connecting_->wait_for_link(std::chrono::milliseconds(0))) {
    used_ = std::exchange(connecting_, nullptr);
    message = "pen: " + name_;
    return true;
  }
  if (now - connecting_since_ >= std::chrono::duration<double>(answer_timeout).count()) {
    message = connection_error(settings);
    connecting_.reset();
  }
  return false;
}

std::string PenDevice::connection_error(const Settings& settings) const {
  return connecting_ ? with_where(settings.device_source, no_answer_error(name_, *connecting_)).message()
                     : "";
}

scene::Scene with_settings(scene::Scene scene, const Settings& settings) {
  if (settings.representation >= 0)
    scene.surface.representation = static_cast<Representation>(std::min(settings.representation, 2));
  if (settings.depth >= 0) scene.surface.depth = settings.depth;
  if (settings.use_paper_method) {
    scene.physics.method = dynamics::ContactMethod::directional;
    scene.physics.normal_method = dynamics::NormalMethod::literal;
  }
  if (!settings.material.empty()) scene.surface.material = *find_material(settings.material);
  scene.pen = session::pen_for(scene);
  if (settings.use_paper_method) scene.pen->method = haptics::HapticMethod::plane;
  if (settings.stiffness >= 0) scene.pen->spring.stiffness = settings.stiffness;
  for (const scene::Cue cue : scene::all_cues)
    if (const auto& changed = settings.cues[std::size_t(cue)]) scene.cues[cue] = *changed;
  return scene;
}

Result<std::string> Stage::open(const std::string& audio, const std::string& device) {
  std::string note;
  auto opened = sound::open_audio_device({audio, 44'100, 512});
  if (!opened) return tl::unexpected(opened.error());
  audio_ = std::move(opened->device);
  note = opened->note;
  if (auto started = audio_->start(tap_); !started) return tl::unexpected(started.error());
  if (auto connected = pen_.open(device); !connected) return tl::unexpected(connected.error());
  return note;
}

Stage::~Stage() {
  session_.reset();
  if (audio_) audio_->stop();
}

void Stage::request_scene(const scene::Scene& scene, const Settings& settings, bool keeps_bodies) {
  LoadRequest request;
  request.scene = with_settings(scene, settings);
  request.options = {settings.moves,
                     settings.feels,
                     settings.hears,
                     cache_folder().empty() ? std::filesystem::path() : cache_folder() / "models",
                     audio_ ? audio_->sample_rate() : 44'100,
                     scene.sound.gain_db + settings.volume};
  request.device = pen_.device();
  request.keeps_bodies = keeps_bodies;
  // Reuses the loaded surface if it is unchanged.
  if (keeps_bodies && session_ != nullptr && requested_settings_ &&
      settings.depth == requested_settings_->depth && settings.material == requested_settings_->material &&
      request.scene.surface.texture == session_->scene().surface.texture &&
      scene::share_surfaces(request.scene.cues, session_->scene().cues) &&
      (request.scene.surface.representation != Representation::relief ||
       session_->surface().surface->has_depth()))
    request.surface = session_->surface();
  requested_settings_ = settings;
  requested_scene_ = scene;
  loader_.request(std::move(request));
}

Result<void> Stage::drop(const std::filesystem::path& file, const Settings& settings) {
  if (file.extension() == ".toml") {
    auto scene = scene::read_scene(file, scene_.allowed_memory);
    if (scene) {
      scene_file_ = file;
      request_scene(*scene, settings, false);
      return {};
    }
    // Not a scene; perhaps a texture's recipe, which has no [surface].
    // Not parsed: searched for that
    if (const auto text = read_file(file, 1 << 20);
        text &&
        std::string_view(reinterpret_cast<const char*>(text->data()), text->size()).find("[surface]") !=
            std::string_view::npos)
      return tl::unexpected(scene.error());
  }
  scene::Scene scene = scene_;
  scene::put_texture(scene.surface, file.string());
  request_scene(scene, settings, false);
  return {};
}

void Stage::set_shaders(const std::filesystem::path& folder) {
  shaders_ = folder;
  if (!folder.empty()) shader_watch_.watch({folder});
  reload_shaders_ = !folder.empty();
}

std::string Stage::update(const Settings& settings, double now) {
  if (requested_settings_) {
    std::string message;
    if (pen_.update(settings, now, message)) request_scene(requested_scene_, settings, true);
    if (!message.empty()) return message;
  }
  if (!shaders_.empty() && renderer_ && (shader_watch_.has_changed(now) || reload_shaders_)) {
    reload_shaders_ = false;
    const auto read = renderer_->reload_shaders(shaders_);
    return read ? "shaders reloaded from " + shaders_.string() : read.error().message();
  }
  if (requested_settings_ && needs_new_session(settings, *requested_settings_))
    request_scene(requested_scene_, settings, true);
  if (!watch_.has_changed(now) || loader_.is_busy()) return "";
  scene::Scene scene = scene_;
  if (!scene_file_.empty()) {
    auto read = scene::read_scene(scene_file_, scene_.allowed_memory);
    if (!read) return read.error().message();
    // A texture that was dropped stays.
    if (scene_.name != scene_file_.string() || read->surface.texture == scene_.surface.texture) scene = *read;
  }
  request_scene(scene, settings, false);
  return "";
}

void SessionCounts::add(session::LiveSession& session) {
  const session::LiveState& state = session.state();
  ticks += session.servo().compute().count();
  skipped_ticks += session.servo().skipped_ticks();
  steps += state.steps;
  skipped_steps += state.dropped_steps;
  if (const auto sound = session.sound_status()) {
    events += sound->events;
    dropped_events += sound->dropped_events;
  }
}

SessionCounts Stage::counts() {
  SessionCounts all = ended_;
  if (session_) all.add(*session_);
  return all;
}

bool Stage::take_loaded(std::string& message) {
  auto loaded = loader_.take();
  if (!loaded) return false;
  if (!loaded->session) {
    message = loaded->error->message();
    requested_scene_ = scene_;
    return false;
  }
  if (session_) {
    session_->stop();
    ended_.add(*session_);
    loaded->session->continue_counters(*session_);
  }
  if (session_ && loaded->request.keeps_bodies) loaded->session->follow(*session_);
  const std::string shown_before = session_ ? scene::cue_note(session_->scene().cues) : "";
  const bool is_other = !session_ || !loaded->request.keeps_bodies;
  scene_ = requested_scene_;
  session_ = std::move(loaded->session);
  session_pen_ = std::move(loaded->request.device);
  picture_ = std::make_unique<scene::ScenePicture>(session_->scene(), session_->surface());
  if (auto shown = show(); !shown) message = shown.error().message();
  session_->start(&tap_, &baker_);
  std::vector<std::filesystem::path> files;
  if (!scene_file_.empty()) files.push_back(scene_file_);
  std::error_code ignored;
  if (std::filesystem::exists(scene_.surface.texture, ignored)) files.emplace_back(scene_.surface.texture);
  watch_.watch(std::move(files));
  if (const std::string note = scene::cue_note(session_->scene().cues);
      message.empty() && note != shown_before)
    message = note.empty() ? "cues: all true" : note;
  if (message.empty() && is_other && !session_->surface().notes.empty())
    message = session_->surface().notes.front();
  return is_other;
}

Result<void> Stage::show() {
  if (!renderer_) return {};
  auto parts = scene::surface_parts(session_->scene(), session_->surface());
  for (render::SurfacePart& part : parts) part.displaced_mesh_cells = drawn_.mesh_cells;
  return renderer_->show(parts);
}

Result<void> Stage::draw(const render::Camera& camera, const Settings& settings, int width, int height,
                         double scale) {
  const PictureOptions wanted{std::max(1, int(std::lround(width * scale))),
                              std::max(1, int(std::lround(height * scale))), settings.samples,
                              std::clamp(settings.mesh, 0, 1024), settings.classic};
  const bool is_new = !renderer_ || drawn_.samples != wanted.samples || drawn_.classic != wanted.classic;
  if (is_new) {
    render::RendererOptions options;
    options.context = render::Context::current;
    options.width = wanted.width;
    options.height = wanted.height;
    options.supersample = std::clamp(settings.samples, 1, 4);
    options.march = settings.classic ? render::March::classic : render::March::pyramid;
    auto made = render::Renderer::create(*session_->surface().surface, options);
    if (!made) return tl::unexpected(made.error());
    renderer_ = std::move(*made);
    reload_shaders_ = !shaders_.empty();
  } else if (wanted.width != drawn_.width || wanted.height != drawn_.height) {
    if (auto resized = renderer_->resize(wanted.width, wanted.height); !resized) return resized;
  }
  const bool has_new_parts = is_new || wanted.mesh_cells != drawn_.mesh_cells;
  drawn_ = wanted;
  if (has_new_parts)
    if (auto shown = show(); !shown) return shown;
  const session::LiveState& state = session_->state();
  const scene::Scene& scene = session_->scene();
  const std::size_t balls = std::min(scene.balls.size(), state.bodies);
  const std::optional<Vec3> tip =
      settings.pen || session_pen_ ? std::optional<Vec3>(state.pen.proxy) : std::nullopt;
  render::FrameScene frame =
      picture_->frame({state.pose.data(), balls}, {state.pose.data() + balls, state.bodies - balls}, tip);
  frame.camera = camera;
  if (!settings.sees) frame.representation = Representation::flat;
  renderer_->draw_to(frame, 0, width, height);
  return {};
}

}  // namespace intaglio::window
