// Relief on curved bases: on a flat one it is the slab's; on a sphere it is the displaced sphere.
#include "render/mesh.h"

#include "mesh/triangle_mesh.h"
#include "tests/render/oracle.h"
#include "tests/render/scenes.h"

namespace intaglio::render::test {

namespace {

std::unique_ptr<Renderer> on_base(const surface::Surface& surface, const surface::TriangleMesh& base,
                                  const RendererOptions& options) {
  auto renderer = make_renderer(surface, options);
  const SurfacePart part{.surface = &surface, .base = &base};
  const auto shown = renderer->show(std::span(&part, 1));
  REQUIRE_MESSAGE(shown.has_value(), (shown ? "" : shown.error().message()));
  return renderer;
}

RendererOptions middling() {
  RendererOptions options = small_options();
  options.width = 320;
  options.height = 180;
  return options;
}

}  // namespace

TEST_CASE("the layer of a mesh has the volume between its two faces, without gaps") {
  const double radius = 0.5, depth = 0.05, pi = std::numbers::pi;
  const auto shell = shell_tetrahedra(surface::make_sphere(radius, 96, 48), depth, {1, 1});
  REQUIRE(shell);
  double volume = 0;
  for (const Tetrahedron& t : *shell) {
    const auto at = [&](std::size_t k) -> Vec3 {
      return Vec3(t.corner[k][0], t.corner[k][1], t.corner[k][2]);
    };
    const double v = (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) / 6;
    CHECK(v > 0);
    volume += v;
  }
  const double inner = radius - depth;
  CHECK(volume ==
        doctest::Approx(4 * pi / 3 * (radius * radius * radius - inner * inner * inner)).epsilon(5e-3));
}

TEST_CASE("a triangle over the edge of a repeated texture is refused, with its number") {
  surface::TriangleMesh base = surface::make_quad(surface::Placement(Vec3::Zero(), Quat::Identity(), 1, 1));
  for (Vec2& uv : base.uvs) uv = 1.5 * uv;
  const auto shell = shell_tetrahedra(base, 0.1, {1, 1}, "floor");
  REQUIRE_FALSE(shell);
  CHECK(shell.error().message().find("triangle 0") != std::string::npos);
  for (Vec2& uv : base.uvs) uv = uv / 1.5 + Vec2(3, -2);
  CHECK(shell_tetrahedra(base, 0.1, {1, 1}));
  CHECK_FALSE(shell_tetrahedra({}, 0.1, {1, 1}));
}

TEST_CASE("relief on a flat base has the slab's depth and colours") {
  if (!have_gl()) return;
  const auto surface = brick();
  const auto slab = make_renderer(surface, middling());
  const auto flat = on_base(surface, surface::make_quad(surface.placement()), middling());
  FrameScene scene = target_scene();
  for (const Vec3& eye : {Vec3(0.05, 0.9, 0.3), Vec3(0.05, 0.48, 0.62)}) {
    scene.camera.eye = eye;
    const Image8 a = slab->draw(scene), b = flat->draw(scene);
    const auto deep = slab->depth(), shallow = flat->depth();
    double sum = 0, both = 0, colour = 0;
    for (std::size_t k = 0; k < deep.size(); ++k) {
      // The slab has walls where its sides are cut; a base has none.
      if (!std::isfinite(shallow[k]) || !std::isfinite(deep[k])) continue;
      sum += (deep[k] - shallow[k]) * (deep[k] - shallow[k]);
      for (std::size_t c = 0; c < 3; ++c) colour += std::abs(int(a.data[3 * k + c]) - int(b.data[3 * k + c]));
      ++both;
    }
    CHECK(both > 10000);
    CHECK(std::sqrt(sum / both) <= 2e-3 * surface.max_depth());
    CHECK(colour / both < 0.5);
  }
}

TEST_CASE("a sphere of uniform depth is the smaller sphere, also in outline") {
  if (!have_gl()) return;
  const double radius = 0.3, deep = 0.03;
  const auto surface = make_surface(
      64, 1.0, deep, [](double, double) { return 0.5; }, Quat::Identity(), surface::Edge::wrap);
  const auto base = surface::make_sphere(radius, 128, 64);
  const auto renderer = on_base(surface, base, middling());
  FrameScene scene = target_scene();
  const Vec3 centre(0.05, 0.02, -0.03);
  scene.part_poses = {{.pose = {centre, Quat(0.8, 0.1, 0.5, -0.3).normalized()}}};
  renderer->draw(scene);
  const auto depth = renderer->depth();
  std::vector<double> truth;
  const Ball ball{.pose = {centre, Quat::Identity()}, .radius = radius - 0.5 * deep};
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 320; ++x) truth.push_back(meet_ball(ball, pixel_ray(scene.camera, 320, 180, x, y)));
  const DepthDifference d = compare_depth(depth, truth);
  MESSAGE("RMS " << d.rms << " m, covered by one only " << d.share_lost);
  CHECK(d.rms < 0.02 * deep);
  CHECK(d.share_lost < 2e-3);  // chords of the base's 128 sides lie 0.09 mm inside the circle
}

}  // namespace intaglio::render::test
