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

void Loader::ask(LoadRequest request) {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = std::move(request);
  }
  wake_.notify_one();
}

std::optional<Loaded> Loader::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, std::nullopt);
}

bool Loader::is_busy() {
  const std::lock_guard lock(mutex_);
  return busy_ || wanted_ || done_;
}

void Loader::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return wanted_ || closed_; });
    if (closed_) return;
    LoadRequest request = std::move(*std::exchange(wanted_, std::nullopt));
    busy_ = true;
    lock.unlock();
    Loaded loaded = load(std::move(request));
    lock.lock();
    done_ = std::move(loaded);
    busy_ = false;
  }
}

namespace {

// Whether these settings need another session.
bool differ(const Settings& a, const Settings& b) {
  const auto key = [](const Settings& s) {
    return std::tuple(s.representation, s.depth, s.stiffness, s.papers_method, s.material, s.moves, s.feels,
                      s.hears);
  };
  return key(a) != key(b);
}

constexpr std::chrono::seconds patience(3);  // with a device that is dialled

Error no_answer(const std::string& device, const haptics::vrpn::VrpnDevice& pen) {
  return {device, "the pen's device does not answer: " + pen.last_failure().error.message(),
          "start its VRPN server (intaglio devices serve is one to try), or use the mouse"};
}

}  // namespace

scene::Scene with_settings(scene::Scene scene, const Settings& settings) {
  if (settings.representation >= 0)
    scene.surface.representation = static_cast<Representation>(std::min(settings.representation, 2));
  if (settings.depth >= 0) scene.surface.depth = settings.depth;
  if (settings.papers_method) {
    scene.physics.method = dynamics::ContactMethod::directional;
    scene.physics.normal_method = dynamics::NormalMethod::literal;
  }
  if (!settings.material.empty()) scene.surface.material = *find_material(settings.material);
  scene.pen = session::pen_for(scene);
  if (settings.papers_method) scene.pen->method = haptics::HapticMethod::plane;
  if (settings.stiffness >= 0) scene.pen->spring.stiffness = settings.stiffness;
  return scene;
}

Result<std::string> Stage::open(const std::string& audio, const std::string& device) {
  std::string note;
  auto opened = sound::open_audio_device({audio, 44'100, 512});
  if (!opened) return tl::unexpected(opened.error());
  audio_ = std::move(opened->device);
  note = opened->note;
  if (auto started = audio_->start(tap_); !started) return tl::unexpected(started.error());
  if (!device.empty()) {
    const auto address = haptics::vrpn::parse_address(device);
    if (!address) return tl::unexpected(address.error());
    pen_ = std::make_shared<haptics::vrpn::VrpnDevice>(*address);
    device_ = device;
    if (!pen_->wait_for_link(patience)) return tl::unexpected(no_answer(device, *pen_));
  }
  return note;
}

Stage::~Stage() {
  session_.reset();
  if (audio_) audio_->stop();
}

void Stage::ask(const scene::Scene& scene, const Settings& settings, bool goes_on) {
  LoadRequest request;
  request.scene = with_settings(scene, settings);
  request.options = {settings.moves,
                     settings.feels,
                     settings.hears,
                     cache_folder().empty() ? std::filesystem::path() : cache_folder() / "models",
                     audio_ ? audio_->sample_rate() : 44'100,
                     scene.sound.gain_db + settings.volume};
  request.device = pen_;
  request.goes_on = goes_on;
  // The texture as it is, when nothing about it has changed.
  if (goes_on && session_ != nullptr && asked_ && settings.depth == asked_->depth &&
      settings.material == asked_->material &&
      request.scene.surface.texture == session_->scene().surface.texture &&
      (request.scene.surface.representation != Representation::relief ||
       session_->surface().surface->has_depth()))
    request.surface = session_->surface();
  asked_ = settings;
  asked_base_ = scene;
  loader_.ask(std::move(request));
}

Result<void> Stage::drop(const std::filesystem::path& file, const Settings& settings) {
  if (file.extension() == ".toml") {
    auto scene = scene::read_scene(file);
    if (scene) {
      scene_file_ = file;
      ask(*scene, settings, false);
      return {};
    }
    // Not a scene: perhaps a recipe of a texture, which has no table of that name.
    if (const auto text = read_file(file, 1 << 20);
        text &&
        std::string_view(reinterpret_cast<const char*>(text->data()), text->size()).find("[surface]") !=
            std::string_view::npos)
      return tl::unexpected(scene.error());
  }
  scene::Scene scene = base_;
  scene::put_texture(scene.surface, file.string());
  ask(scene, settings, false);
  return {};
}

void Stage::set_shaders(const std::filesystem::path& folder) {
  shaders_ = folder;
  if (!folder.empty()) shader_watch_.watch({folder});
  wants_shaders_ = !folder.empty();
}

// Another device is dialled while the old one is used; the session that follows has it.
std::string Stage::keep_pen(const Settings& settings, double now) {
  if (settings.device != device_) {
    device_ = settings.device;
    dialled_.reset();
    if (device_.empty()) {
      pen_.reset();
      ask(asked_base_, settings, true);
      return "the mouse is the pen";
    }
    const auto address = haptics::vrpn::parse_address(device_);
    if (!address) return with_where(settings.device_from, address.error()).message();
    dialled_ = std::make_shared<haptics::vrpn::VrpnDevice>(*address);
    dialled_since_ = now;
  }
  if (!dialled_) return "";
  if (dialled_->wait_for_link(std::chrono::milliseconds(0))) {
    pen_ = std::exchange(dialled_, nullptr);
    ask(asked_base_, settings, true);
    return device_ + " is the pen";
  }
  if (now - dialled_since_ < std::chrono::duration<double>(patience).count()) return "";
  const std::string said = unanswered(settings);
  dialled_.reset();
  return said;
}

std::string Stage::unanswered(const Settings& settings) const {
  return dialled_ ? with_where(settings.device_from, no_answer(device_, *dialled_)).message() : "";
}

std::string Stage::keep_up(const Settings& settings, double now) {
  if (std::string said = asked_ ? keep_pen(settings, now) : ""; !said.empty()) return said;
  if (!shaders_.empty() && renderer_ && (shader_watch_.has_changed(now) || wants_shaders_)) {
    wants_shaders_ = false;
    const auto read = renderer_->reload_shaders(shaders_);
    return read ? "shaders of " + shaders_.string() : read.error().message();
  }
  if (asked_ && differ(settings, *asked_)) ask(asked_base_, settings, true);
  if (!watch_.has_changed(now) || loader_.is_busy()) return "";
  scene::Scene scene = base_;
  if (!scene_file_.empty()) {
    auto read = scene::read_scene(scene_file_);
    if (!read) return read.error().message();
    // A texture that was dropped stays.
    if (base_.name != scene_file_.string() || read->surface.texture == base_.surface.texture) scene = *read;
  }
  ask(scene, settings, false);
  return "";
}

bool Stage::poll(std::string& message) {
  auto loaded = loader_.take();
  if (!loaded) return false;
  if (!loaded->session) {
    message = loaded->error->message();
    asked_base_ = base_;
    return false;
  }
  if (session_) {
    session_->stop();
    loaded->session->continue_counters(*session_);
  }
  if (session_ && loaded->request.goes_on) loaded->session->follow(*session_);
  const bool is_other = !session_ || !loaded->request.goes_on;
  base_ = asked_base_;
  session_ = std::move(loaded->session);
  sessions_pen_ = std::move(loaded->request.device);
  picture_ = std::make_unique<scene::ScenePicture>(session_->scene(), session_->surface());
  if (auto shown = show(); !shown) message = shown.error().message();
  session_->start(&tap_, &baker_);
  std::vector<std::filesystem::path> files;
  if (!scene_file_.empty()) files.push_back(scene_file_);
  std::error_code ignored;
  if (std::filesystem::exists(base_.surface.texture, ignored)) files.emplace_back(base_.surface.texture);
  watch_.watch(std::move(files));
  if (message.empty() && is_other && !session_->surface().notes.empty())
    message = session_->surface().notes.front();
  return is_other;
}

Result<void> Stage::show() {
  if (!renderer_) return {};
  auto parts = scene::surface_parts(session_->scene(), session_->surface());
  for (render::SurfacePart& part : parts) part.mesh_cells = mesh_;
  return renderer_->show(parts);
}

Result<void> Stage::draw(const render::Camera& camera, const Settings& settings, int width, int height,
                         double scale) {
  const int wide = std::max(1, static_cast<int>(std::lround(width * scale)));
  const int high = std::max(1, static_cast<int>(std::lround(height * scale)));
  if (!renderer_ || samples_ != settings.samples || classic_ != settings.classic) {
    render::RendererOptions options;
    options.context = render::Context::callers;
    options.width = wide;
    options.height = high;
    options.supersample = std::clamp(settings.samples, 1, 4);
    options.march = settings.classic ? render::March::classic : render::March::pyramid;
    auto made = render::Renderer::create(*session_->surface().surface, options);
    if (!made) return tl::unexpected(made.error());
    renderer_ = std::move(*made);
    samples_ = settings.samples;
    classic_ = settings.classic;
    wants_shaders_ = !shaders_.empty();
    picture_width_ = wide;
    picture_height_ = high;
    if (auto shown = show(); !shown) return shown;
  }
  if (wide != picture_width_ || high != picture_height_) {
    if (auto resized = renderer_->resize(wide, high); !resized) return resized;
    picture_width_ = wide;
    picture_height_ = high;
  }
  if (const int wanted = std::clamp(settings.mesh, 0, 1024); wanted != mesh_) {
    mesh_ = wanted;
    if (auto shown = show(); !shown) return shown;
  }
  const session::LiveState& state = session_->state();
  const scene::Scene& scene = session_->scene();
  const std::size_t balls = std::min(scene.balls.size(), state.bodies);
  const std::optional<Vec3> tip =
      settings.pen || sessions_pen_ ? std::optional<Vec3>(state.pen.proxy) : std::nullopt;
  render::FrameScene frame =
      picture_->frame({state.pose.data(), balls}, {state.pose.data() + balls, state.bodies - balls}, tip);
  frame.camera = camera;
  if (!settings.sees) frame.representation = Representation::flat;
  renderer_->draw_to(frame, 0, width, height);
  return {};
}

}  // namespace intaglio::window
