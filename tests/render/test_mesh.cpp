// The traced relief beside the same texture as a displaced mesh.
#include "intaglio/representation.h"
#include "render/mesh.h"
#include "tests/render/oracle.h"
#include "tests/render/scenes.h"

namespace intaglio::render::test {

TEST_CASE("a slab's mesh is closed and has the volume that the relief leaves of the slab") {
  const double deep = 0.1, slab = 0.3;
  const auto surface = make_surface(32, 1.0, deep, [](double u, double v) { return 0.5 * u + 0.3 * v; });
  const Mesh mesh = slab_mesh(surface, 64, slab);
  double volume = 0;
  Vec3 area = Vec3::Zero();
  for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
    const Vec3 a = vec(mesh.vertices[mesh.indices[k]].position),
               b = vec(mesh.vertices[mesh.indices[k + 1]].position),
               c = vec(mesh.vertices[mesh.indices[k + 2]].position);
    volume += a.dot(b.cross(c)) / 6;
    area += (b - a).cross(c - a) / 2;
    CHECK((b - a).cross(c - a).dot(vec(mesh.vertices[mesh.indices[k]].normal)) >= 0);
  }
  CHECK(area.norm() < 1e-6);  // of any closed surface
  double mean = 0;
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) mean += surface.depth({(i + 0.5) / 64, (j + 0.5) / 64}) / 4096;
  CHECK(volume == doctest::Approx(slab - mean).epsilon(1e-3));
}

TEST_CASE("traced relief matches a mesh of 1024 x 1024 squares in depth and coverage") {
  if (!have_gl()) return;
  const auto surface = brick();
  RendererOptions options = small_options();
  options.width = 320;
  options.height = 180;
  const auto traced = make_renderer(surface, options);
  options.displaced_mesh_cells = 1024;
  const auto meshed = make_renderer(surface, options);
  CHECK(meshed->device_bytes().meshes > 20 * meshed->device_bytes().textures);
  FrameScene scene = target_scene();
  // Grazing, a brick's edge within a 256th of a pixel, the rasteriser's own grid, decides which brick is
  // seen: there the mesh is farther from the truth than the trace is.
  const bool grazing[] = {false, false, true};
  const Vec3 eyes[] = {Vec3(0.05, 0.9, 0.3), Vec3(0.05, 0.48, 0.62), Vec3(0.3, 0.12, 0.7)};
  for (int k = 0; k < 3; ++k) {
    scene.camera.eye = eyes[k];
    traced->draw(scene);
    meshed->draw(scene);
    const auto truth = slab_depth(surface, options, scene.camera);
    const DepthDifference d = compare_depth(traced->depth(), meshed->depth());
    const double trace = compare_depth(traced->depth(), truth).rms / surface.max_depth(),
                 mesh = compare_depth(meshed->depth(), truth).rms / surface.max_depth();
    MESSAGE("eye " << eyes[k].y() << " m up: RMS over relief depth " << d.rms / surface.max_depth()
                   << " (from the truth: trace " << trace << ", mesh " << mesh << "), covered by one only "
                   << d.share_lost);
    CHECK(trace <= 0.002);
    if (grazing[k])
      CHECK(mesh > trace);
    else
      CHECK(d.rms <= 0.01 * surface.max_depth());
    CHECK(d.share_lost <= 1e-4);
  }
}

TEST_CASE("a mesh is drawn for relief only, in the colours of traced relief") {
  if (!have_gl()) return;
  const auto surface = brick();
  RendererOptions options = small_options();
  const auto traced = make_renderer(surface, options);
  options.displaced_mesh_cells = 256;
  const auto meshed = make_renderer(surface, options);
  FrameScene scene = target_scene();
  const auto difference = [&] {
    const Image8 a = traced->draw(scene), b = meshed->draw(scene);
    double sum = 0;
    for (std::size_t k = 0; k < a.data.size(); ++k) sum += std::abs(a.data[k] - b.data[k]);
    return sum / double(a.data.size());
  };
  const double relief = difference();
  CHECK(relief > 0.1);  // it has no normal map
  CHECK(relief < 6);
  scene.representation = Representation::normal;
  CHECK(difference() == 0);
}

}  // namespace intaglio::render::test
