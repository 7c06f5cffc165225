// The physics world of a scene, with flippers on keys, bumpers, and bodies that return to their start when
// they have fallen off. One thread at a time.
//
// Bodies are numbered as in Scene; the pen is not in the world.
#pragma once

#include <vector>

#include "dynamics/world.h"
#include "intaglio/representation.h"
#include "scene/scene.h"
#include "scene/surfaces.h"

namespace intaglio::scene {

// Bits of the flippers' keys.
inline constexpr unsigned left_key = 1, right_key = 2;

class SceneWorld {
 public:
  SceneWorld(const Scene& scene, const SceneSurface& surface, Representation representation);

  dynamics::World& world() { return world_; }
  const dynamics::World& world() const { return world_; }
  // One physics step with these keys held.
  void step(unsigned keys = 0);
  // Returns all bodies to their start; time runs on.
  void reset();

  BodyId ball(std::size_t k) const { return BodyId(k + 1); }
  BodyId body(std::size_t k) const { return BodyId(balls_.size() + k + 1); }
  BodyId pen() const { return BodyId(balls_.size() + bodies_.size() + 1); }
  std::size_t count() const { return balls_.size() + bodies_.size(); }
  // As drawn; balls, then bodies.
  Pose pose(std::size_t k) const { return world_.drawn_pose(BodyId(k + 1)); }
  bool is_free(BodyId id) const;
  double mass(BodyId id) const;  // kg

  // Copies poses and velocities from another world of the same scene (another representation, say).
  void follow(const SceneWorld& other);

 private:
  void drive_flippers(unsigned keys);
  void apply_bumpers();
  void respawn();
  void respawn_body(std::size_t k);

  std::vector<BallSettings> balls_;
  std::vector<BodySettings> bodies_;
  std::optional<double> respawn_below_;
  double step_;
  std::vector<double> raised_;  // of each body's flipper, 0 at rest to 1 fully raised
  dynamics::World world_;
};

}  // namespace intaglio::scene
