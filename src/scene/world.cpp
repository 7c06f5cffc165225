#include "scene/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "intaglio/representation.h"
#include "intaglio/vec.h"

namespace intaglio::scene {

namespace {

constexpr double flipper_seconds = 0.06;  // from rest to fully raised, and back

dynamics::WorldOptions world_options(const Scene& scene, Representation representation) {
  dynamics::WorldOptions options;
  options.representation = representation;
  options.method = scene.physics.method;
  options.gravity = scene.physics.gravity;
  options.step = 1.0 / scene.physics.rate;
  options.normal_method = scene.physics.normal_method;
  // Only in scenes with bodies, so that scenes of balls alone keep their sound.
  options.report_pairs = !scene.bodies.empty();
  return options;
}

}  // namespace

SceneWorld::SceneWorld(const Scene& scene, const SceneSurface& surface, Representation representation)
    : balls_(scene.balls),
      bodies_(scene.bodies),
      respawn_below_(scene.physics.respawn_below),
      step_(1.0 / scene.physics.rate),
      raised_(scene.bodies.size(), 0.0),
      world_(surface.surface, surface.material, world_options(scene, representation)) {
  for (std::size_t k = 0; k < surface.grounds.size(); ++k) {
    const SceneSurface& ground = surface.grounds[k];
    if (ground.curved) {
      world_.add_surface(*ground.curved, ground.material, scene.grounds[k].thickness);
    } else {
      world_.add_surface(ground.surface, ground.material);
    }
  }
  for (const BallSettings& ball : balls_) world_.add(ball);
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    world_.add(k < surface.reliefs.size() ? textured(bodies_[k], surface.reliefs[k]) : bodies_[k].body);
}

bool SceneWorld::is_free(BodyId id) const {
  if (id < 1 || id > count()) return false;
  return id <= balls_.size() || bodies_[id - balls_.size() - 1].body.motion == dynamics::Motion::free;
}

double SceneWorld::mass(BodyId id) const {
  return id <= balls_.size() ? balls_[id - 1].mass() : bodies_[id - balls_.size() - 1].body.mass();
}

void SceneWorld::step(unsigned keys) {
  drive_flippers(keys);
  world_.step();
  apply_bumpers();
  if (respawn_below_) respawn();
}

void SceneWorld::drive_flippers(unsigned keys) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!bodies_[k].flipper) continue;
    const Flipper& flipper = *bodies_[k].flipper;
    const bool pressed = (keys & (flipper.key == 0 ? left_key : right_key)) != 0;
    const double turn = step_ / flipper_seconds;
    raised_[k] = std::clamp(raised_[k] + (pressed ? turn : -turn), 0.0, 1.0);
    const Quat turned = rotation(raised_[k] * flipper.sweep * std::numbers::pi / 180, flipper.axis);
    const Pose& rest = bodies_[k].body.pose;
    world_.drive(body(k), {rest.to_world(flipper.pivot - turned * flipper.pivot), rest.orientation * turned});
  }
}

// A bumper adds speed along the contact's normal to each ball that begins to touch it.
void SceneWorld::apply_bumpers() {
  for (const ContactEvent& event : world_.events()) {
    if (is_surface(event.other) || event.other <= balls_.size() || event.other > count()) continue;
    const double speed = bodies_[event.other - balls_.size() - 1].kick;
    if (speed <= 0 || event.body > balls_.size() || event.phase != ContactPhase::begin) continue;
    const BallSettings& ball = balls_[event.body - 1];
    world_.push(event.body, ball.mass() * speed * event.n_g);
  }
}

void SceneWorld::respawn() {
  for (std::size_t k = 0; k < count(); ++k) {
    const auto id = BodyId(k + 1);
    if (is_free(id) && world_.pose(id).position.y() < *respawn_below_) respawn_body(k);
  }
}

void SceneWorld::respawn_body(std::size_t k) {
  const auto id = BodyId(k + 1);
  if (k < balls_.size()) {
    const BallSettings& ball = balls_[k];
    world_.put(id, {ball.position, Quat::Identity()}, ball.velocity, ball.angular_velocity);
  } else if (is_free(id)) {
    const dynamics::ShapeBody& body = bodies_[k - balls_.size()].body;
    world_.put(id, body.pose, body.velocity, body.angular_velocity);
  }
}

void SceneWorld::reset() {
  for (std::size_t k = 0; k < count(); ++k) respawn_body(k);
}

void SceneWorld::follow(const SceneWorld& other) {
  for (std::size_t k = 0; k < std::min(count(), other.count()); ++k) {
    const auto id = BodyId(k + 1);
    if (is_free(id) && other.is_free(id))
      world_.put(id, other.pose(k), other.world_.drawn_velocity(id), other.world_.angular_velocity(id));
  }
}

}  // namespace intaglio::scene
