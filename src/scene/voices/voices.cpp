#include "scene/voices/voices.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <numbers>
#include <thread>
#include <utility>

#include "core/hash.h"
#include "sound/bake/bake.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/model_file.h"

namespace intaglio::scene {

namespace {

// Loads or bakes each distinct model of a scene once: twenty equal balls share one.
class ModelBaker {
 public:
  ModelBaker(const std::string& scene, int modes, const VoiceOptions& options)
      : scene_(scene), options_(options) {
    bake_.modes.count = modes;
    bake_.modes.stop = options.stop;
  }

  // Adds a sounding body. `shape` identifies the mesh: equal shapes and materials share one model.
  void add(sound::SoundBody body, const std::string& name, const std::string& shape,
           std::function<sound::TetMesh()> mesh, const Material& material) {
    Hash hash = sound::bake_hash(material, bake_);
    hash.add(std::string_view(shape));
    const std::string identity = fmt::format("{:016x}", hash.value());
    if (models_.try_emplace(identity).second) voices_.models.push_back(identity);
    sounding_.push_back({std::move(body), name, identity, std::move(mesh), material});
  }

  Result<Voices> voices() {
    if (models_.size() > max_models)
      return fail(scene_, fmt::format("has bodies of {} different sizes and materials", models_.size()),
                  fmt::format("at most {} are analysed: let bodies be equal", max_models));
    for (Sounding& sounding : sounding_) {
      Model& model = models_[sounding.identity];
      if (!model) {
        if (options_.progress) options_.progress(loaded_, int(models_.size()));
        model = load_or_bake(sounding);
        ++loaded_;
      }
      if (error_) return tl::unexpected(*error_);
      add_voice(std::move(sounding), model);
    }
    return std::move(voices_);
  }

 private:
  using Model = std::shared_ptr<const sound::ModalModel>;

  struct Sounding {
    sound::SoundBody body;
    std::string name, identity;
    std::function<sound::TetMesh()> mesh;
    Material material;
  };

  void add_voice(Sounding sounding, const Model& model) {
    Voice voice{sounding.body.id, sounding.name, sounding.material.name, {}, {}};
    for (const double omega : model->angular_frequency)
      voice.frequencies.push_back(omega / (2 * std::numbers::pi));
    for (const double damping : model->damping) voice.t60.push_back(std::log(1000.0) / damping);
    voices_.voices.push_back(std::move(voice));
    sounding.body.mass = model->mass;
    sounding.body.model = model;
    voices_.bodies.push_back(std::move(sounding.body));
  }

  // Null for a model that cannot be read or has another identity: it is baked again.
  static Model load(const std::filesystem::path& folder, const std::string& identity) {
    const auto file = folder / (identity + ".modes");
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return nullptr;
    auto read = sound::read_model(file);
    if (!read || read->identity != identity) return nullptr;
    return std::make_shared<const sound::ModalModel>(std::move(*read));
  }

  Model load_or_bake(const Sounding& sounding) {
    const auto& [body, name, identity, mesh, material] = sounding;
    if (!options_.shipped.empty()) {
      const auto folder = std::filesystem::path(scene_).parent_path() / options_.shipped;
      if (auto model = load(folder, identity)) return model;
    }
    if (!options_.cache.empty())
      if (auto model = load(options_.cache, identity)) return model;
    if (sound::stop_requested(options_.stop) || sound::stop_requested(options_.begin_none)) {
      error_ = Error{scene_, "modal analysis was stopped", ""};
      return nullptr;
    }
    sound::BakeOptions bake = bake_;
    bake.identity = identity;
    auto baked = sound::bake(mesh(), material, bake);
    if (!baked) {
      error_ = Error{
          scene_,
          fmt::format("modal analysis of the {} of {} failed: {}", name, material.name, baked.error().what),
          "make it stiffer, smaller or thicker: soft, large, thin bodies have too many audible modes"};
      return nullptr;
    }
    ++voices_.baked;
    // A failed write to the cache is ignored: it only costs time later.
    if (!options_.cache.empty()) (void)sound::write_model(options_.cache / (identity + ".modes"), *baked);
    return std::make_shared<const sound::ModalModel>(std::move(*baked));
  }

  std::string scene_;
  VoiceOptions options_;
  sound::BakeOptions bake_;
  std::map<std::string, Model> models_;  // null before they are loaded
  int loaded_ = 0;
  std::vector<Sounding> sounding_;
  Voices voices_;
  std::optional<Error> error_;
};

// `cells` elements along the longest side; one through a thin side (below 15 % of the longest).
sound::TetMesh box_mesh(const Vec3& size, int cells) {
  const auto along = [&](double side) {
    const int n = int(std::lround(cells * side / size.maxCoeff()));
    return std::clamp(n, side > 0.15 * size.maxCoeff() ? 2 : 1, cells);
  };
  return sound::box(size, along(size.x()), along(size.y()), along(size.z()));
}

// A curved ground rings like the flat slab over its bounds.
void add_curved(ModelBaker& baker, BodyId id, const std::string& name, const SurfaceSettings& ground,
                const SceneSurface& made) {
  const surface::Bounds bounds = made.curved->bounds();
  const Vec3 size(bounds.sizes().x(), ground.thickness, bounds.sizes().z());
  sound::SoundBody body;
  body.id = id;
  body.is_fixed = true;
  if (ground.representation != Representation::flat) body.textures = {made.surface};
  body.rest_pose.position = bounds.center();
  baker.add(
      body, name, fmt::format("slab {} {} {}", size.x(), size.y(), size.z()),
      [size] { return box_mesh(size, 16); }, made.material);
}

void add_slab(ModelBaker& baker, BodyId id, const std::string& name, const SurfaceSettings& slab,
              const SceneSurface& made) {
  // The slab hangs below the base plane; its modal model is a box about its middle, Y up.
  sound::SoundBody body;
  body.id = id;
  body.is_fixed = true;
  if (slab.representation != Representation::flat) body.textures = heard_textures(made);
  body.rest_pose = {
      made.surface->placement().to_world({slab.size.x() / 2, slab.size.y() / 2, -slab.thickness / 2}),
      rotation_of(slab.rotation)};
  // Finer than box_mesh(), and one element through the slab however thick it is: identities depend on it.
  constexpr int cells = 24;
  const auto along = [&](double side) {
    return std::clamp(int(std::lround(cells * side / slab.size.maxCoeff())), 2, cells);
  };
  const auto mesh = [size = Vec3(slab.size.x(), slab.thickness, slab.size.y()), across = along(slab.size.x()),
                     deep = along(slab.size.y())] { return sound::box(size, across, 1, deep); };
  baker.add(body, name, fmt::format("slab {} {} {}", slab.size.x(), slab.thickness, slab.size.y()), mesh,
            made.material);
}

// How to mesh a shape, and the text that identifies the mesh.
struct MeshRecipe {
  std::string identity;
  std::function<sound::TetMesh()> mesh;
};
MeshRecipe cylinder(double radius, double length) {
  return {fmt::format("cylinder {} {}", radius, length), [=] {
            const int layers = std::clamp(int(std::lround(length / radius)), 2, 16);
            return sound::cylinder(radius, length, 2, layers);
          }};
}
MeshRecipe mesh_recipe(const contact::Shape& shape) {
  if (const auto* s = std::get_if<contact::Sphere>(&shape))
    return {fmt::format("ball {}", s->radius), [r = s->radius] { return sound::ball(r, 2); }};
  if (const auto* s = std::get_if<contact::Cylinder>(&shape)) return cylinder(s->radius, 2 * s->half_height);
  // A cylinder of nearly the capsule's volume: 2/3 r for each cap would be all of it.
  if (const auto* s = std::get_if<contact::Capsule>(&shape))
    return cylinder(s->radius, 2 * (s->half_height + 0.6 * s->radius));
  Vec3 half = Vec3::Constant(contact::bounding_radius(shape) / std::sqrt(3.0));
  if (const auto* s = std::get_if<contact::Box>(&shape)) half = s->half;
  if (const auto* s = std::get_if<contact::Compound>(&shape)) {
    half.setZero();
    for (const contact::CompoundChild& child : *s->children)
      if (const auto* box = std::get_if<contact::Box>(&child.shape))
        half = half.cwiseMax(child.pose.position.cwiseAbs() + box->half);
  }
  return {fmt::format("box {} {} {}", half.x(), half.y(), half.z()),
          [half] { return box_mesh(2 * half, 8); }};
}

void add_bodies(ModelBaker& baker, const Scene& scene, const SceneSurface& surface) {
  for (std::size_t k = 0; k < scene.balls.size(); ++k) {
    const BallSettings& ball = scene.balls[k];
    sound::SoundBody body;
    body.id = Scene::ball_id(k);
    body.radius_of_curvature = ball.radius;
    const std::string name = scene.balls.size() == 1 ? "ball" : fmt::format("ball {}", k + 1);
    baker.add(
        body, name, fmt::format("ball {}", ball.radius),
        [radius = ball.radius] { return sound::ball(radius, 2); }, ball.material);
  }
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const BodySettings& from = scene.bodies[k];
    sound::SoundBody body;
    body.id = scene.body_id(k);
    body.is_fixed = from.body.motion != dynamics::Motion::free;
    body.rest_pose = from.body.pose;
    if (k < surface.reliefs.size() && scene.surface.representation != Representation::flat)
      for (const SceneSurface& relief : surface.reliefs[k]) body.textures.push_back(relief.surface);
    const MeshRecipe recipe = mesh_recipe(from.body.shape);
    baker.add(body, fmt::format("{} {}", from.name, k + 1), recipe.identity, recipe.mesh, from.body.material);
  }
}

}  // namespace

Result<Voices> bake_voices(const Scene& scene, const SceneSurface& surface, const VoiceOptions& options) {
  ModelBaker baker(scene.name, scene.sound.modes, options);
  add_slab(baker, floor_body, "floor", scene.surface, surface);
  for (std::size_t k = 0; k < surface.grounds.size(); ++k)
    (surface.grounds[k].curved ? add_curved : add_slab)(baker, BodyId(first_surface_body + k),
                                                        fmt::format("ground {}", k + 1), scene.grounds[k],
                                                        surface.grounds[k]);
  add_bodies(baker, scene, surface);
  if (scene.pen) {
    sound::SoundBody body;
    body.id = scene.pen_id();
    body.radius_of_curvature = 0.001;  // of the tip, not of the shaft
    baker.add(
        body, "pen", fmt::format("pen {} {}", scene.pen->radius, scene.pen->length),
        [radius = scene.pen->radius, length = scene.pen->length] {
          return sound::cylinder(radius, length, 1, 16);
        },
        scene.pen->material);
  }
  return baker.voices();
}

sound::SynthesizerOptions synthesizer_options(const Scene& scene) {
  sound::SynthesizerOptions options;
  options.sample_rate = scene.sound.sample_rate;
  options.seed = std::uint64_t(scene.seed);
  options.micro_level *= scene.sound.micro;
  options.meso = scene.sound.meso.value_or(scene.surface.representation == Representation::normal
                                               ? sound::MesoSource::normal_map
                                               : sound::MesoSource::engine_impulses);
  return options;
}

struct VoiceBaker::State {
  struct Request {
    std::uint64_t ticket = 0;
    Scene scene;
    SceneSurface surface;
    std::filesystem::path cache;
  };

  std::mutex mutex;
  std::condition_variable wake;
  std::optional<Request> pending;
  std::uint64_t tickets = 0, done_ticket = 0;
  std::optional<Result<Voices>> done;
  bool busy = false;
  std::atomic<bool> superseded{false};  // there is a newer request than the one being worked on
  std::atomic<bool> stop{false};
};

VoiceBaker::VoiceBaker() : state_(std::make_unique<State>()), thread_([this] { work(*state_); }) {}

VoiceBaker::~VoiceBaker() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stop = true;
    state_->wake.notify_one();
  }
  thread_.join();
}

std::uint64_t VoiceBaker::request(const Scene& scene, const SceneSurface& surface,
                                  const std::filesystem::path& cache) {
  const std::lock_guard lock(state_->mutex);
  state_->pending = {++state_->tickets, scene, surface, cache};
  state_->superseded = true;
  state_->wake.notify_one();
  return state_->tickets;
}

std::optional<Result<Voices>> VoiceBaker::take(std::uint64_t ticket) {
  const std::lock_guard lock(state_->mutex);
  if (!state_->done || state_->done_ticket != ticket) return std::nullopt;
  return std::exchange(state_->done, std::nullopt);
}

bool VoiceBaker::is_busy() const {
  const std::lock_guard lock(state_->mutex);
  return state_->busy || state_->pending;
}

void VoiceBaker::work(State& state) {
  // Low priority: physics and pictures go first. On Linux each thread has its own niceness; failure is
  // harmless.
  (void)setpriority(PRIO_PROCESS, id_t(gettid()), 10);
  std::unique_lock lock(state.mutex);
  while (true) {
    state.wake.wait(lock, [&] { return state.pending || state.stop; });
    if (state.stop) return;
    const State::Request request = std::move(*std::exchange(state.pending, std::nullopt));
    state.superseded = false;
    state.busy = true;
    lock.unlock();
    auto voices = bake_voices(request.scene, request.surface,
                              {.cache = request.cache, .stop = &state.stop, .begin_none = &state.superseded});
    lock.lock();
    state.busy = false;
    if (state.pending) continue;
    state.done = std::move(voices);
    state.done_ticket = request.ticket;
  }
}

}  // namespace intaglio::scene
