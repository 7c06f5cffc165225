#include "scene/api.h"

#include <utility>

namespace intaglio {

namespace {

Scene handle_of(scene::Scene scene) {
  return Scene(std::make_shared<const Scene::Impl>(Scene::Impl{std::move(scene)}));
}

// A copy that `change` has changed.
template <class Change>
Scene changed(const Scene::Impl& from, const Change& change) {
  scene::Scene scene = from.scene;
  change(scene);
  return handle_of(std::move(scene));
}

}  // namespace

Result<Scene> Scene::load(const std::filesystem::path& path) {
  return scene::read_scene(path).map([](scene::Scene scene) { return handle_of(std::move(scene)); });
}
Result<Scene> Scene::parse(std::string_view text, const std::string& name) {
  return scene::parse_scene(text, name).map([](scene::Scene scene) { return handle_of(std::move(scene)); });
}

const std::string& Scene::title() const {
  return impl_->scene.title;
}
double Scene::duration() const {
  return impl_->scene.duration;
}
Representation Scene::representation() const {
  return impl_->scene.surface.representation;
}
std::size_t Scene::body_count() const {
  return impl_->scene.balls.size() + impl_->scene.bodies.size();
}
bool Scene::has_pen() const {
  return impl_->scene.pen.has_value();
}

Scene Scene::with_duration(double seconds) const {
  return changed(*impl_, [&](scene::Scene& scene) { scene.duration = seconds; });
}
Scene Scene::with_representation(Representation representation) const {
  return changed(*impl_, [&](scene::Scene& scene) { scene.surface.representation = representation; });
}
Scene Scene::with_texture(const std::string& texture) const {
  return changed(*impl_, [&](scene::Scene& scene) { scene::put_texture(scene.surface, texture); });
}
Scene Scene::with_allowed_memory(std::uint64_t bytes) const {
  return changed(*impl_, [&](scene::Scene& scene) { scene.allowed_memory = bytes; });
}
Scene Scene::with_picture(int width, int height, int fps) const {
  return changed(*impl_, [&](scene::Scene& scene) {
    scene.video.width = width;
    scene.video.height = height;
    scene.video.fps = fps;
  });
}

Result<Surface> Scene::floor() const {
  const scene::SurfaceSettings& from = impl_->scene.surface;
  if (from.base)
    return fail(impl_->scene.name, "has a curved floor", "load its texture with CurvedSurface::load");
  SurfaceOptions options;
  options.size = from.size;
  options.pose = {from.position, scene::rotation_of(from.rotation)};
  options.depth = from.depth;
  options.edge = from.edge == surface::Edge::wrap ? Edge::wrap : Edge::clamp;
  options.mode = from.mode == surface::ImportMode::fused ? ImportMode::fused : ImportMode::raw;
  if (from.green)
    options.green = *from.green == surface::Green::plus_y ? GreenChannel::plus_y : GreenChannel::minus_y;
  if (from.polarity)
    options.white = *from.polarity == surface::Polarity::depth ? WhiteMeans::deep : WhiteMeans::high;
  return Surface::load(from.texture, options);
}

}  // namespace intaglio
