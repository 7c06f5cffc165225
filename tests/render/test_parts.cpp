// Meshes, the height pyramid, invalid options and threads.
#include <rapidcheck.h>

#include <numbers>
#include <thread>

#include "render/mesh.h"
#include "render/surface_textures.h"
#include "tests/render/scenes.h"

namespace intaglio::render::test {

namespace {

// Every triangle faces the way its normals point; returns the enclosed volume.
double check_outward(const Mesh& mesh) {
  double volume = 0;
  for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
    const Vertex& a = mesh.vertices[mesh.indices[k]];
    const Vertex& b = mesh.vertices[mesh.indices[k + 1]];
    const Vertex& c = mesh.vertices[mesh.indices[k + 2]];
    const Vec3 face = (vec(b.position) - vec(a.position)).cross(vec(c.position) - vec(a.position));
    volume += vec(a.position).dot(vec(b.position).cross(vec(c.position))) / 6;
    if (face.norm() < 1e-9) continue;
    for (const Vertex& v : {a, b, c}) {
      CHECK(vec(v.normal).norm() == doctest::Approx(1).epsilon(1e-5));
      CHECK(face.normalized().dot(vec(v.normal)) > 0.9);
    }
  }
  return volume;
}

}  // namespace

TEST_CASE("meshes are closed, face outward and have the volume of their solid") {
  const double pi = std::numbers::pi;
  CHECK(check_outward(unit_sphere()) == doctest::Approx(4 * pi / 3).epsilon(5e-3));
  const double r = 0.01;
  const double cone = pen_tip_radii * r;
  CHECK(check_outward(pen_mesh(0.2, r)) ==
        doctest::Approx(pi * r * r * (0.2 - cone + cone / 3)).epsilon(5e-3));
}

TEST_CASE("the height pyramid bounds its cells, tightly, and halves exactly") {
  CHECK(rc::check([] {
    const int width = *rc::gen::inRange(2, 80);
    const int height = *rc::gen::inRange(2, 80);
    const auto z = *rc::gen::container<std::vector<float>>(
        std::size_t(width * height),
        rc::gen::map(rc::gen::inRange(-999, 1), [](int k) { return float(k) / 1000; }));
    const HeightPyramid pyramid = make_height_pyramid({width, height, z});
    for (std::size_t k = 0; k < pyramid.levels.size(); ++k) {
      const auto& level = pyramid.levels[k];
      RC_ASSERT(level.width << k == pyramid.levels[0].width && level.height << k == pyramid.levels[0].height);
      std::vector<float> expected(level.z.size(), -1e9f);
      for (int j = 0; j + 1 < height; ++j) {
        for (int i = 0; i + 1 < width; ++i) {
          float& top = expected[std::size_t((j >> k) * level.width + (i >> k))];
          for (const int corner :
               {j * width + i, j * width + i + 1, (j + 1) * width + i, (j + 1) * width + i + 1}) {
            top = std::max(top, z[std::size_t(corner)]);
          }
        }
      }
      RC_ASSERT(level.z == expected);
    }
  }));
}

TEST_CASE("invalid options are refused with the valid range") {
  if (!have_gl()) return;
  const auto surface = brick();
  const auto refused = [&](auto change, const char* word) {
    RendererOptions options = small_options();
    change(options);
    const auto renderer = Renderer::create(surface, options);
    REQUIRE(!renderer.has_value());
    CHECK(renderer.error().message().find(word) != std::string::npos);
    CHECK(!renderer.error().fix.empty());
  };
  refused([](RendererOptions& o) { o.supersample = 0; }, "supersample is 0");
  refused([](RendererOptions& o) { o.width = 0; }, "0 x 90");
  refused([](RendererOptions& o) { o.width = 1 << 20; }, "1048576 x 90");
  refused([](RendererOptions& o) { o.linear_steps = 0; }, "0 linear");
  refused([](RendererOptions& o) { o.roughness = 2; }, "roughness is 2");
}

TEST_CASE("a renderer can be made in one thread, drawn in another and destroyed in a third") {
  if (!have_gl()) return;
  const FrameScene scene = target_scene();
  auto renderer = make_renderer(brick(), small_options());
  const Image8 here = renderer->draw(scene);
  Image8 there;
  std::thread([&] { there = renderer->draw(scene); }).join();
  CHECK(there.data == here.data);
  CHECK(renderer->draw(scene).data == here.data);
  std::thread([&] { renderer.reset(); }).join();
}

TEST_CASE("renderers do not disturb each other") {
  if (!have_gl()) return;
  const FrameScene scene = target_scene();
  const auto a = make_renderer(brick(), small_options());
  const Image8 before = a->draw(scene);
  {
    const auto b =
        make_renderer(make_surface(16, 1, 0.1, [](double u, double) { return u; }), small_options());
    CHECK(b->draw(scene).data != before.data);
    CHECK(a->draw(scene).data == before.data);
  }
  CHECK(a->draw(scene).data == before.data);
}

}  // namespace intaglio::render::test
