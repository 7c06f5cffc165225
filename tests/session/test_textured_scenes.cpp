// The scenes with curved grounds and textured bodies show what they are made for.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "intaglio/representation.h"
#include "mesh/api.h"
#include "scene/picture.h"
#include "scene/surfaces.h"
#include "scene/world.h"
#include "tests/source_folder.h"

using namespace intaglio;
using namespace intaglio::scene;

namespace {

struct Played {
  Scene scene;
  SceneSurface surface;
  std::unique_ptr<SceneWorld> world;

  explicit Played(const std::string& name, Representation representation = Representation::relief) {
    auto read = read_scene(std::string(tests::source_folder) + "/scenes/" + name + ".toml");
    REQUIRE_MESSAGE(read, (read ? "" : read.error().message()));
    scene = std::move(*read);
    auto made = make_surface(scene);
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message()));
    surface = std::move(*made);
    world = std::make_unique<SceneWorld>(scene, surface, representation);
  }
  template <class Look>
  void run(double seconds, const Look& look) {
    for (int n = 0; n < seconds * scene.physics.rate; ++n) {
      world->step();
      look();
    }
  }
};

}  // namespace

TEST_CASE("gratings: blocks with ridges hold on the slope and on each other, flat ones slide" *
          doctest::test_suite("statistics")) {
  Played played("gratings");
  double slid = 0;
  std::set<std::pair<BodyId, BodyId>> met;
  const double from = played.world->pose(3).position.z();
  played.run(1.5, [&] {
    slid = std::max(slid, played.world->pose(3).position.z() - from);
    for (const ContactEvent& e : played.world->world().events()) met.insert({e.body, e.other});
  });
  const Pose lower = played.world->pose(0), upper = played.world->pose(1);
  played.run(2, [] {});
  const double lower_moved = (played.world->pose(0).position - lower.position).norm(),
               upper_moved = (played.world->pose(1).position - upper.position).norm();
  MESSAGE("in two seconds the lower block moved " << 1000 * lower_moved << " mm, the upper one "
                                                  << 1000 * upper_moved << "; the flat pair " << slid
                                                  << " m in the first 1.5 s");
  CHECK(lower_moved < 0.5e-3);
  CHECK(upper_moved < 0.5e-3);
  CHECK(slid > 0.2);
  CHECK(met.count({1, floor_body}) == 1);
  CHECK(met.count({1, 2}) == 1);
  CHECK(met.count({3, floor_body}) == 1);
}

TEST_CASE("bowl: balls stay in it, also when it is smooth; the picture has the bowl's inside and its back") {
  for (const Representation representation : {Representation::relief, Representation::flat}) {
    Played played("bowl", representation);
    double farthest = 0;
    int contacts = 0;
    played.run(3, [&] {
      for (std::size_t k = 0; k < played.world->count(); ++k)
        farthest = std::max(farthest, (played.world->pose(k).position - Vec3(0, 0.375, 0)).norm());
      for (const ContactEvent& e : played.world->world().events())
        contacts += e.other == first_surface_body ? 1 : 0;
    });
    CHECK(farthest < 0.36 + 0.01);
    CHECK(contacts > 300);
    const auto parts = surface_parts(played.scene, played.surface);
    REQUIRE(parts.size() == 2);
    CHECK(parts[0].base == nullptr);
    CHECK(parts[1].base != nullptr);
    CHECK(ScenePicture(played.scene, played.surface).frame({}, {}, std::nullopt).solids.size() == 1);
  }
}

TEST_CASE("the back of an open base has a rim, a closed base none") {
  BaseSettings base;
  const auto bowl = make_base(base, {});
  REQUIRE(bowl);
  const auto& mesh = bowl->mesh();
  const render::Mesh back = back_mesh(mesh, 0.001, 0.02);
  // One per base triangle, and two per edge of the rim, which has 64.
  CHECK(back.indices.size() == 3 * (mesh.triangles.size() + 2 * 64));
  base.shape = BaseSettings::Shape::sphere;
  const auto ball = make_base(base, {});
  REQUIRE(ball);
  CHECK(back_mesh(ball->mesh(), 0.001, 0.02).indices.empty());
  // The mean length of its circles of latitude, weighted by area, and half a meridian.
  const Vec2 size = surface::texture_size(ball->mesh());
  CHECK(size.x() == doctest::Approx(0.5 * 3.14159265 * 3.14159265 * 0.3).epsilon(0.01));
  CHECK(size.y() == doctest::Approx(3.14159265 * 0.3).epsilon(0.01));
}

TEST_CASE("a body's texture that is too deep or missing is an error") {
  auto scene = parse_scene("[[body]]\nsize = [0.1, 0.02, 0.1]\ntop = { depth = 0.03 }\n", "s.toml");
  REQUIRE(scene);
  const auto deep = make_surface(*scene);
  REQUIRE_FALSE(deep);
  CHECK(deep.error().message().find("thick") != std::string::npos);
  scene = parse_scene("[[ground]]\nbase = { shape = \"sphere\", radius = 0.02 }\ndepth = 0.03\n", "s.toml");
  REQUIRE(scene);
  CHECK_FALSE(make_surface(*scene));
  scene = parse_scene("[[ground]]\nbase = { shape = \"mesh\", file = \"none.glb\" }\n", "s.toml");
  REQUIRE(scene);
  const auto missing = make_surface(*scene);
  REQUIRE_FALSE(missing);
  CHECK(missing.error().message().find("none.glb") != std::string::npos);
}
