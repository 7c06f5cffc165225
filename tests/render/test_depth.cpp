// The depth picture shows the same field as surface::Surface.
#include "intaglio/representation.h"
#include "tests/render/oracle.h"
#include "tests/render/scenes.h"

namespace intaglio::render::test {

namespace {

// RMS of the depth picture against brute force, as a fraction of the relief's depth.
DepthDifference against_oracle(const surface::Surface& surface, March march, const Camera& camera) {
  RendererOptions options = small_options();
  options.march = march;
  options.linear_steps = 160;
  options.binary_steps = 7;
  const auto renderer = make_renderer(surface, options);
  FrameScene scene;
  scene.camera = camera;
  renderer->draw(scene);
  DepthDifference d = compare_depth(renderer->depth(), slab_depth(surface, options, camera));
  d.rms /= surface.max_depth();
  return d;
}

Camera grazing() {
  Camera camera;
  camera.eye = Vec3(0.3, 0.12, 0.7);
  camera.target = Vec3(0, 0, 0.1);
  return camera;
}

}  // namespace

TEST_CASE(
    "relief depth equals brute force: pyramid within 0.2 % of the relief; classic within 5 %, 10 % when "
    "grazing") {
  if (!have_gl()) return;
  const auto surface = brick();
  for (const bool low : {false, true}) {
    const Camera camera = low ? grazing() : target_scene().camera;
    const DepthDifference classic = against_oracle(surface, March::classic, camera);
    const DepthDifference pyramid = against_oracle(surface, March::pyramid, camera);
    MESSAGE("camera " << camera.eye.y() << " m up: RMS over relief depth, classic " << classic.rms
                      << ", pyramid " << pyramid.rms);
    // The linear search misses bricks' edges that the ray barely clips.
    CHECK(classic.rms <= (low ? 0.10 : 0.05));
    CHECK(pyramid.rms <= 0.002);
    CHECK(classic.share_lost <= 0.001);
    CHECK(pyramid.share_lost <= 0.0005);
  }
}

TEST_CASE("the edge rule and the walls are the surface's: a coarse, lopsided texture under both rules") {
  if (!have_gl()) return;
  const auto lopsided = [](double u, double v) { return std::clamp(0.15 + 0.5 * u + 0.3 * v * v, 0.0, 1.0); };
  Camera camera;
  camera.eye = Vec3(1.1, 0.7, 0.9);
  camera.fov_y_degrees = 50;
  for (const auto edge : {surface::Edge::wrap, surface::Edge::clamp}) {
    const auto surface = make_surface(7, 1.0, 0.2, lopsided, Quat::Identity(), edge);
    const DepthDifference d = against_oracle(surface, March::pyramid, camera);
    CHECK(d.rms <= 0.002);
    CHECK(d.share_lost <= 0.001);
  }
}

TEST_CASE("a camera below, beside or inside the slab sees walls, not holes") {
  if (!have_gl()) return;
  const auto surface = brick();
  Camera below;
  below.eye = Vec3(0.3, -0.8, 0.7);
  Camera beside;
  beside.eye = Vec3(0.1, -0.005, 1.0);
  beside.target = Vec3(0.1, -0.005, 0);
  Camera in_mortar;  // in the joint along u at v = 1/2, above its floor
  in_mortar.eye = Vec3(-0.3, -0.003, 0.0);
  in_mortar.target = Vec3(0.5, -0.008, 0.0);
  in_mortar.near = 0.001;
  for (const Camera& camera : {below, beside, in_mortar}) {
    const DepthDifference d = against_oracle(surface, March::pyramid, camera);
    CHECK(d.rms <= 0.01);
    CHECK(d.share_lost <= 0.001);
  }
}

TEST_CASE("a relief without depth has the depth of the plane") {
  if (!have_gl()) return;
  const auto zero = [](double, double) { return 0.0; };
  for (const double max_depth : {0.0, 0.02}) {
    for (const March march : {March::classic, March::pyramid}) {
      RendererOptions options = small_options();
      options.march = march;
      options.linear_steps = 160;
      options.binary_steps = 7;
      const auto renderer = make_renderer(make_surface(32, 1.0, max_depth, zero), options);
      FrameScene scene = target_scene();
      scene.representation = Representation::flat;
      renderer->draw(scene);
      const auto plane = renderer->depth();
      scene.representation = Representation::relief;
      renderer->draw(scene);
      const DepthDifference d = compare_depth(renderer->depth(), plane);
      CHECK(d.rms <= 1e-5);
      CHECK(d.share_lost == 0);
    }
  }
}

TEST_CASE("a relief without depth is drawn with its normals, not black") {
  if (!have_gl()) return;
  const auto renderer = make_renderer(make_surface(64, 1.0, 0.0, brick_depth), small_options());
  FrameScene scene = target_scene();
  scene.representation = Representation::normal;
  const auto normal = renderer->draw(scene);
  scene.representation = Representation::relief;
  CHECK(renderer->draw(scene).data == normal.data);
}

TEST_CASE("flat and normal representations have the depth of the plane") {
  if (!have_gl()) return;
  const auto renderer = make_renderer(brick(), small_options());
  FrameScene scene = target_scene();
  scene.representation = Representation::flat;
  renderer->draw(scene);
  const auto flat = renderer->depth();
  scene.representation = Representation::normal;
  renderer->draw(scene);
  CHECK(renderer->depth() == flat);
  const auto plane = make_surface(1024, 1.0, 0.0, [](double, double) { return 0.0; });
  const DepthDifference d = compare_depth(flat, slab_depth(plane, small_options(), scene.camera));
  CHECK(d.rms <= 1e-5);
  CHECK(d.share_lost <= 0.002);
}

}  // namespace intaglio::render::test
