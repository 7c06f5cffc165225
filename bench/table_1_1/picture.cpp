#include "bench/table_1_1/picture.h"

#include <array>
#include <memory>

#include "bench/brick.h"
#include "intaglio/representation.h"
#include "render/mesh.h"
#include "render/renderer.h"

namespace intaglio::bench {

namespace {

using render::Camera;

struct Way {
  std::string name;
  Representation representation = Representation::relief;
  int mesh_cells = 0;
  bool looks_away = false;
  bool is_plain = false;   // the mesh in one colour, without the texture's normals and self-shadow
  bool has_shadow = true;  // whether the relief shadows itself
  std::shared_ptr<const render::Mesh> solid = {};  // of a plain one
  std::unique_ptr<render::Renderer> renderer = {};
  std::vector<double> ms = {};
};

// From above, from aside, grazing, as in bench_render.
std::array<Camera, 3> cameras() {
  std::array<Camera, 3> out;
  out[0].eye = Vec3(0.05, 0.9, 0.35);
  out[1].eye = Vec3(0.05, 0.48, 0.62);
  out[2].eye = Vec3(0.3, 0.12, 0.7);
  out[2].target = Vec3(0, 0, 0.1);
  return out;
}

render::FrameScene scene_of(const Way& way, const Camera& camera) {
  render::FrameScene scene;
  scene.camera = camera;
  if (way.looks_away) scene.camera.target = 2 * camera.eye - camera.target;
  scene.representation = way.representation;
  if (way.solid) scene.solids.push_back({{}, way.solid});
  return scene;
}

std::shared_ptr<const render::Mesh> in_world(render::Mesh mesh, const surface::Placement& placement) {
  const auto turned = [](const std::array<float, 3>& v, const auto& turn) {
    const Vec3 out = turn(Vec3(double(v[0]), double(v[1]), double(v[2])));
    return std::array<float, 3>{float(out.x()), float(out.y()), float(out.z())};
  };
  for (render::Vertex& vertex : mesh.vertices) {
    vertex.position = turned(vertex.position, [&](const Vec3& p) { return placement.to_world(p); });
    vertex.normal = turned(vertex.normal, [&](const Vec3& n) { return placement.direction_to_world(n); });
  }
  return std::make_shared<const render::Mesh>(std::move(mesh));
}

std::vector<Way> all_ways(const surface::Surface& surface) {
  std::vector<Way> ways;
  const auto add = [&](const char* name, Representation representation, int cells = 0) -> Way& {
    ways.emplace_back();
    ways.back().name = name;
    ways.back().representation = representation;
    ways.back().mesh_cells = cells;
    return ways.back();
  };
  add("normal map", Representation::normal);
  add("relief map", Representation::relief);
  add("coarse mesh", Representation::relief, 255);
  add("fine mesh", Representation::relief, 511);
  add("relief map, no shadow", Representation::relief).has_shadow = false;
  add("coarse mesh, plain", Representation::relief, 255).is_plain = true;
  add("fine mesh, plain", Representation::relief, 511).is_plain = true;
  add("an empty picture", Representation::normal).looks_away = true;
  for (Way& way : ways) {
    if (!way.is_plain) continue;
    way.solid = in_world(render::slab_mesh(surface, way.mesh_cells, 0.03), surface.placement());
  }
  return ways;
}

}  // namespace

Result<PictureCosts> measure_pictures(int width, int height, int rounds) {
  const surface::Surface surface = brick(512);
  const surface::Surface out_of_sight =
      surface.placed({Vec3(0, -1000, 0), Quat::Identity(), 1, 1}, surface.max_depth());
  std::vector<Way> ways = all_ways(surface);
  for (Way& way : ways) {
    render::RendererOptions options;
    options.width = width;
    options.height = height;
    options.supersample = 1;
    if (!way.is_plain) options.displaced_mesh_cells = way.mesh_cells;
    if (!way.has_shadow) options.shadow_steps = 0;
    auto renderer = render::Renderer::create(way.is_plain ? out_of_sight : surface, options);
    if (!renderer) return tl::unexpected(renderer.error());
    way.renderer = std::move(*renderer);
  }
  for (int round = -1; round < rounds; ++round) {
    for (const Camera& camera : cameras()) {
      for (Way& way : ways) {
        const render::FrameScene scene = scene_of(way, camera);
        const double start = process_seconds();
        way.renderer->draw(scene);
        if (round >= 0) way.ms.push_back(1e3 * (process_seconds() - start));
      }
    }
  }
  PictureCosts out{ways[0].renderer->device(), {}};
  for (Way& way : ways) {
    const auto bytes = way.renderer->device_bytes();
    const double held =
        way.solid ? 24.0 * double(way.solid->vertices.size()) + 4.0 * double(way.solid->indices.size())
                  : double(way.mesh_cells > 0 ? bytes.meshes : bytes.textures);
    out.rows.push_back({way.name, width, height, summary(std::move(way.ms)), held});
  }
  return out;
}

}  // namespace intaglio::bench
