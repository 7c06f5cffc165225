// A difference along v alone shows at the correct end of the picture, and so along u: a texture loaded upside
// down looks plausible, but fails here.
#include "intaglio/representation.h"
#include "tests/render/scenes.h"

namespace intaglio::render::test {

namespace {

// Straight down, u to the right of the picture and v up.
FrameScene from_above() {
  FrameScene scene;
  scene.camera.eye = Vec3(0, 1.4, 0);
  scene.camera.up = -Vec3::UnitZ();
  return scene;
}

float pixel(const std::vector<float>& depth, int x, int y) {
  return depth[std::size_t(y * 160 + x)];
}

}  // namespace

TEST_CASE("depth: u goes right and v goes up") {
  if (!have_gl()) return;
  for (const March march : {March::classic, March::pyramid}) {
    RendererOptions options = small_options();
    options.march = march;
    const auto deep_high_v =
        make_renderer(make_surface(64, 1, 0.1, [](double, double v) { return v > 0.5 ? 1 : 0; }), options);
    deep_high_v->draw(from_above());
    const auto by_v = deep_high_v->depth();
    CHECK(pixel(by_v, 80, 20) == doctest::Approx(1.5).epsilon(1e-3));  // above the middle of the picture
    CHECK(pixel(by_v, 80, 70) == doctest::Approx(1.4).epsilon(1e-3));
    const auto deep_high_u =
        make_renderer(make_surface(64, 1, 0.1, [](double u, double) { return u > 0.5 ? 1 : 0; }), options);
    deep_high_u->draw(from_above());
    const auto by_u = deep_high_u->depth();
    CHECK(pixel(by_u, 110, 45) == doctest::Approx(1.5).epsilon(1e-3));  // right of the middle
    CHECK(pixel(by_u, 50, 45) == doctest::Approx(1.4).epsilon(1e-3));
  }
}

TEST_CASE("colours and normals: u goes right and v goes up") {
  if (!have_gl()) return;
  surface::Texels texels;
  texels.width = texels.height = 2;
  // Upper row tilted towards +v, lower row towards -v.
  texels.normal = {Vec3(0, -0.6, 0.8), Vec3(0, -0.6, 0.8), Vec3(0, 0.6, 0.8), Vec3(0, 0.6, 0.8)};
  texels.colour = Image8(2, 2, 3);  // row 0 is v = 0
  texels.colour.data = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  const surface::Surface surface(std::move(texels), surface::Placement(Vec3::Zero(), Quat::Identity(), 1, 1),
                                 0, surface::Edge::clamp);
  const auto renderer = make_renderer(surface, small_options());
  FrameScene scene = from_above();
  scene.representation = Representation::flat;
  const Image8 flat = renderer->draw(scene);
  const auto is = [&](int x, int y, bool r, bool g, bool b) {
    return (flat.at(x, y, 0) > 60) == r && (flat.at(x, y, 1) > 60) == g && (flat.at(x, y, 2) > 60) == b;
  };
  CHECK(is(55, 70, true, false, false));
  CHECK(is(105, 70, false, true, false));
  CHECK(is(55, 20, false, false, true));
  CHECK(is(105, 20, true, true, true));
  // A sun on the +v side lights the upper row more than the lower; compare each with itself under the
  // mirrored sun.
  scene.representation = Representation::normal;
  scene.light.direction = Vec3(0, 1, -1);
  const Image8 sun_high_v = renderer->draw(scene);
  scene.light.direction = Vec3(0, 1, 1);
  const Image8 sun_low_v = renderer->draw(scene);
  CHECK(sun_high_v.at(105, 20, 0) > sun_low_v.at(105, 20, 0));
  CHECK(sun_high_v.at(55, 70, 0) < sun_low_v.at(55, 70, 0));
}

}  // namespace intaglio::render::test
