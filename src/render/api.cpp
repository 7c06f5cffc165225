#include <map>
#include <utility>

#include "core/file.h"
#include "intaglio/render.h"
#include "mesh/api.h"
#include "render/mesh.h"
#include "render/renderer.h"

namespace intaglio {

namespace {

// Stands in until the first view, so that creating a renderer shows whether there is a driver at all.
surface::Surface placeholder() {
  surface::Texels texels{2, 2, {0, 0, 0, 0}, std::vector<Vec3>(4, Vec3::UnitZ()), Image8(1, 1, 3)};
  return surface::Surface(std::move(texels), surface::Placement(Vec3::Zero(), Quat::Identity(), 1, 1), 0,
                          surface::Edge::clamp);
}

std::shared_ptr<const render::Mesh> mesh_of(const TriangleMesh& from) {
  auto mesh = std::make_shared<render::Mesh>();
  const auto floats = [](const Vec3& v) { return std::array{float(v.x()), float(v.y()), float(v.z())}; };
  for (std::size_t k = 0; k < from.positions.size(); ++k)
    mesh->vertices.push_back({floats(from.positions[k]), floats(from.normals[k])});
  for (const auto& triangle : from.triangles)
    for (const int corner : triangle) mesh->indices.push_back(std::uint32_t(corner));
  return mesh;
}

render::Camera camera_of(const Camera& from) {
  return {from.eye, from.target, from.up, from.fov_y_degrees, from.near, from.far};
}
render::Light light_of(const Light& from) {
  return {from.direction, from.position, from.radius_degrees, from.colour, from.sky, from.ground};
}

}  // namespace

Result<void> Picture::save(const std::filesystem::path& path) const {
  return write_file(path, encode_png(image));
}

struct Renderer::Impl {
  std::unique_ptr<render::Renderer> renderer;
  double slab_thickness;
  // The current surfaces, kept alive so that an address identifies one.
  std::vector<Surface> surfaces = {};
  std::vector<CurvedSurface> curved = {};
  std::map<std::shared_ptr<const TriangleMesh>, std::shared_ptr<const render::Mesh>> meshes = {};

  bool shows(const View& view) const;
  Result<void> show(const View& view);
  render::FrameScene frame(const View& view);
};

bool Renderer::Impl::shows(const View& view) const {
  if (view.surfaces.size() != surfaces.size() || view.curved.size() != curved.size()) return false;
  for (std::size_t k = 0; k < surfaces.size(); ++k)
    if (&surfaces[k].impl() != &view.surfaces[k].impl()) return false;
  for (std::size_t k = 0; k < curved.size(); ++k)
    if (&curved[k].impl() != &view.curved[k].surface.impl()) return false;
  return true;
}

Result<void> Renderer::Impl::show(const View& view) {
  std::vector<render::SurfacePart> parts;
  for (const Surface& surface : view.surfaces)
    parts.push_back({.surface = surface.impl().surface.get(),
                     .slab_thickness = slab_thickness,
                     .roughness = surface.impl().roughness});
  for (const DrawnCurved& drawn : view.curved)
    parts.push_back({.surface = drawn.surface.surface().impl().surface.get(),
                     .slab_thickness = slab_thickness,
                     .roughness = drawn.surface.surface().impl().roughness,
                     .base = &drawn.surface.mesh()});
  if (parts.empty()) return fail("View", "has no surface", "give at least one");
  auto shown = renderer->show(parts);
  if (!shown) return shown;
  surfaces = view.surfaces;
  curved.clear();
  for (const DrawnCurved& drawn : view.curved) curved.push_back(drawn.surface);
  return {};
}

render::FrameScene Renderer::Impl::frame(const View& view) {
  render::FrameScene scene;
  scene.camera = camera_of(view.camera);
  scene.light = light_of(view.light);
  scene.representation = view.representation;
  scene.part_poses.resize(view.surfaces.size());
  for (const DrawnCurved& drawn : view.curved) scene.part_poses.push_back({drawn.pose, drawn.shadow_radius});
  for (const DrawnBall& ball : view.balls)
    scene.balls.push_back({ball.pose, ball.radius, ball.colour, ball.second_colour});
  decltype(meshes) wanted;
  for (const DrawnMesh& drawn : view.meshes) {
    auto& mesh = wanted[drawn.mesh];
    if (!mesh) {
      const auto known = meshes.find(drawn.mesh);
      mesh = known != meshes.end() ? known->second : mesh_of(*drawn.mesh);
    }
    scene.solids.push_back({drawn.pose, mesh, drawn.colour, drawn.shadow_radius});
  }
  meshes = std::move(wanted);
  if (view.pen) {
    scene.pen.emplace();
    scene.pen->tip = view.pen->tip;
    scene.pen->direction = view.pen->direction;
    scene.pen->length = view.pen->length;
    scene.pen->radius = view.pen->radius;
  }
  return scene;
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Result<Renderer> Renderer::headless(int width, int height, const RendererOptions& from) {
  render::RendererOptions options;
  options.width = width;
  options.height = height;
  options.supersample = from.supersample;
  options.march = from.exact ? render::March::pyramid : render::March::classic;
  options.shadow_steps = from.shadow_steps;
  options.slab_thickness = from.slab_thickness;
  auto renderer = render::Renderer::create(placeholder(), options);
  if (!renderer) return tl::unexpected(renderer.error());
  return Renderer(std::unique_ptr<Impl>(new Impl{std::move(*renderer), from.slab_thickness}));
}

Result<Picture> Renderer::draw(const View& view) {
  if (!impl_->shows(view)) {
    if (const auto shown = impl_->show(view); !shown) return tl::unexpected(shown.error());
  }
  return Picture{impl_->renderer->draw(impl_->frame(view))};
}

std::vector<float> Renderer::depth() const {
  return impl_->renderer->depth();
}
std::string Renderer::device() const {
  return impl_->renderer->device();
}

}  // namespace intaglio
