// Rendering for a window: the caller's context, changing sizes, several surfaces, solids.
#include "render/mesh.h"
#include "tests/render/scenes.h"

using namespace intaglio;
using namespace intaglio::render;
using namespace intaglio::render::test;

namespace {

surface::Surface waves(const Vec3& centre = Vec3::Zero()) {
  surface::Texels t;
  t.width = t.height = 32;
  for (int k = 0; k < 32 * 32; ++k) {
    t.depth.push_back(k % 32 < 16 ? 0.0f : 1.0f);
    t.normal.push_back(Vec3::UnitZ());
  }
  return surface::Surface(std::move(t), surface::Placement(centre, Quat::Identity(), 1, 1), 0.05,
                          surface::Edge::clamp);
}

double mean_difference(const Image8& a, const Image8& b) {
  REQUIRE(a.data.size() == b.data.size());
  double sum = 0;
  for (std::size_t k = 0; k < a.data.size(); ++k) sum += std::abs(int(a.data[k]) - int(b.data[k]));
  return sum / double(a.data.size());
}

}  // namespace

TEST_CASE("a renderer in the caller's context draws what one with its own does") {
  if (!have_gl()) return;
  const surface::Surface surface = waves();
  RendererOptions options = small_options();
  FrameScene scene;
  scene.balls.emplace_back().pose.position = {0, 0.1, 0};
  auto own = Renderer::create(surface, options);
  REQUIRE(own);
  const Image8 expected = (*own)->draw(scene);

  auto context = EglContext::create();
  REQUIRE(context);
  const CurrentContext scope(*context);
  options.context = Context::current;
  auto renderer = Renderer::create(surface, options);
  REQUIRE(renderer);
  CHECK((*renderer)->draw(scene).data == expected.data);
  const auto captured = (*renderer)->capture(options.width, options.height);
  REQUIRE(captured);
  CHECK(captured->data == expected.data);
  CHECK_FALSE((*renderer)->capture(0, 10));
}

TEST_CASE("a renderer with a context of its own leaves the caller's current") {
  if (!have_gl()) return;
  auto context = EglContext::create();
  REQUIRE(context);
  const CurrentContext scope(*context);
  const std::string before = description_of_current();
  auto renderer = Renderer::create(waves(), small_options());
  REQUIRE(renderer);
  CHECK(description_of_current() == before);
  (*renderer)->draw({});
  CHECK(description_of_current() == before);
  renderer->reset();
  CHECK(description_of_current() == before);
}

TEST_CASE("pictures change their size; an invalid size changes nothing") {
  if (!have_gl()) return;
  auto renderer = Renderer::create(waves(), small_options());
  REQUIRE(renderer);
  FrameScene scene;
  REQUIRE((*renderer)->resize(64, 48));
  const Image8 small = (*renderer)->draw(scene);
  CHECK(small.width == 64);
  CHECK(small.height == 48);
  CHECK_FALSE((*renderer)->resize(0, 48));
  CHECK((*renderer)->draw(scene).data == small.data);
}

TEST_CASE("several surfaces are each drawn in place, in any order after the first") {
  if (!have_gl()) return;
  const surface::Surface a = waves({-0.6, 0, 0}), b = waves({0.6, 0, 0}), c = waves({0.6, 0.3, -0.9});
  auto renderer = Renderer::create(a, small_options());
  REQUIRE(renderer);
  FrameScene scene;
  scene.camera.eye = {0, 1.2, 1.8};
  const Image8 one = (*renderer)->draw(scene);
  const SurfacePart parts[] = {{&a}, {&b}, {&c}};
  REQUIRE((*renderer)->show(parts));
  const Image8 three = (*renderer)->draw(scene);
  CHECK(mean_difference(one, three) > 1);
  const SurfacePart turned[] = {{&a}, {&c}, {&b}};
  REQUIRE((*renderer)->show(turned));
  CHECK(mean_difference(three, (*renderer)->draw(scene)) == 0);
}

TEST_CASE("a solid ball looks like a ball and casts its shadow") {
  if (!have_gl()) return;
  auto renderer = Renderer::create(waves(), small_options());
  REQUIRE(renderer);
  FrameScene scene;
  Ball ball;
  ball.pose.position = {-0.2, 0.1, 0.1};
  ball.radius = 0.1;
  ball.colour = ball.second_colour = {0.62, 0.30, 0.10};
  scene.balls.push_back(ball);
  const Image8 expected = (*renderer)->draw(scene);
  const std::vector<float> depth = (*renderer)->depth();
  scene.balls.clear();
  Mesh mesh = unit_sphere();
  for (Vertex& v : mesh.vertices)
    for (float& x : v.position) x *= 0.1f;
  Solid solid;
  solid.pose = ball.pose;
  solid.mesh = std::make_shared<const Mesh>(mesh);
  solid.colour = ball.colour;
  solid.shadow_radius = 0.1;
  scene.solids.push_back(solid);
  CHECK(mean_difference(expected, (*renderer)->draw(scene)) < 0.6);  // its gloss is another
  const std::vector<float> again = (*renderer)->depth();
  double worst = 0;
  for (std::size_t k = 0; k < depth.size(); ++k)
    if (std::isfinite(depth[k])) worst = std::max(worst, double(std::abs(depth[k] - again[k])));
  CHECK(worst < 1e-4);
}
