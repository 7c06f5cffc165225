#include "bench/table_1_1/picture.h"

#include <array>
#include <memory>

#include "bench/brick.h"
#include "intaglio/representation.h"
#include "render/renderer.h"

namespace intaglio::bench {

namespace {

using render::Camera;

struct Way {
  std::string name;
  Representation representation = Representation::relief;
  int mesh_cells = 0;
  bool looks_away = false;
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
  return scene;
}

}  // namespace

Result<PictureCosts> measure_pictures(int width, int height, int rounds) {
  const surface::Surface surface = brick(512);
  std::vector<Way> ways;
  ways.push_back({"normal map", Representation::normal});
  ways.push_back({"relief map"});
  ways.push_back({"coarse mesh", Representation::relief, 255});
  ways.push_back({"fine mesh", Representation::relief, 511});
  ways.push_back({"an empty picture", Representation::normal, 0, true});
  for (Way& way : ways) {
    render::RendererOptions options;
    options.width = width;
    options.height = height;
    options.supersample = 1;
    options.displaced_mesh_cells = way.mesh_cells;
    auto renderer = render::Renderer::create(surface, options);
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
    out.rows.push_back({way.name, width, height, summary(std::move(way.ms)),
                        double(way.mesh_cells > 0 ? bytes.meshes : bytes.textures)});
  }
  return out;
}

}  // namespace intaglio::bench
