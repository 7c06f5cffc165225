#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

#include "mesh/triangle_mesh.h"
#include "window/view_camera.h"

using namespace intaglio;
using namespace intaglio::window;

namespace {

render::Camera camera() {
  render::Camera c;
  c.eye = {0.3, 0.7, 1.1};
  c.target = {0.1, -0.1, 0.2};
  c.fov_y_degrees = 40;
  return c;
}

double coordinate() {
  return *rc::gen::inRange(-1000, 1001) * 1e-3;
}

}  // namespace

TEST_CASE("the ray through a point's projection passes through the point") {
  rc::check([] {
    const Projection projection(camera(), 16.0 / 9);
    const Vec3 point(coordinate(), coordinate(), coordinate());
    const auto place = projection.project(point);
    if (!place) return;
    const Vec3 ray = projection.ray(*place), to = point - projection.eye;
    RC_ASSERT(ray.cross(to).norm() < 1e-9 * to.norm());
    RC_ASSERT(ray.dot(to) > 0);
  });
}

TEST_CASE(
    "orbit keeps target and distance, look keeps the eye, pan and fly keep the view; home restores the start") {
  rc::check([] {
    const render::Camera start = camera();
    ViewCamera view(start);
    const double a = coordinate(), b = coordinate();
    const double distance = (start.eye - start.target).norm();
    view.orbit(a, b);
    RC_ASSERT((view.camera().target - start.target).norm() < 1e-12);
    RC_ASSERT(std::abs((view.camera().eye - view.camera().target).norm() - distance) < 1e-9);
    const Vec3 eye = view.camera().eye;
    view.look(a, b);
    RC_ASSERT((view.camera().eye - eye).norm() < 1e-12);
    const Vec3 way = view.camera().target - view.camera().eye;
    view.pan(b, a);
    view.fly({a, b, 0.5});
    RC_ASSERT((view.camera().target - view.camera().eye - way).norm() < 1e-9);
    view.zoom(3);
    RC_ASSERT(view.camera().eye.allFinite());
    view.home();
    RC_ASSERT((view.camera().eye - start.eye).norm() == 0);
  });
}

TEST_CASE("the nearest body on a ray is picked, at its surface; a ray beside all bodies picks nothing") {
  scene::Scene scene;
  scene.balls.resize(2);
  scene.balls[0].radius = scene.balls[1].radius = 0.1;
  scene::BodySettings box;
  box.body.shape = contact::Box{{0.1, 0.2, 0.1}};
  scene.bodies.push_back(box);
  const Pose poses[] = {
      {{0, 0, -1}, Quat::Identity()}, {{0, 0, -2}, Quat::Identity()}, {{1, 0, -1}, Quat::Identity()}};
  const auto near = pick_body(scene, poses, Vec3::Zero(), -Vec3::UnitZ());
  REQUIRE(near);
  CHECK(near->body == 1);
  CHECK((near->point - Vec3(0, 0, -0.9)).norm() < 1e-12);
  const auto boxed = pick_body(scene, poses, {1, 0, 0}, -Vec3::UnitZ());
  REQUIRE(boxed);
  CHECK(boxed->body == 3);
  CHECK(boxed->distance == doctest::Approx(0.9));
  CHECK_FALSE(pick_body(scene, poses, {0.5, 0, 0}, -Vec3::UnitZ()));
  CHECK_FALSE(pick_body(scene, poses, {0, 0, -3}, -Vec3::UnitZ()));
}

TEST_CASE("a ray into a bowl hits its inside, not its back; one beside it hits nothing") {
  const surface::TriangleMesh bowl = surface::make_bowl(0.5, 128, 64);
  const Vec3 eye(0.3, 1, 0.2), down = -Vec3::UnitY();
  const auto met = pick_base(bowl, eye, down);
  REQUIRE(met);
  CHECK(met->point.norm() == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(met->point.x() == doctest::Approx(0.3));
  CHECK((met->normal + met->point.normalized()).norm() < 0.03);
  // From the side the near wall shows its back: the ray hits the far one.
  const auto far = pick_base(bowl, Vec3(0, -0.2, 2), -Vec3::UnitZ());
  REQUIRE(far);
  CHECK(far->point.z() < 0);
  CHECK_FALSE(pick_base(bowl, eye + Vec3(1, 0, 0), down));
  CHECK_FALSE(pick_base(bowl, eye, Vec3::UnitY()));
}
