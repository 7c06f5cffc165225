// The rigid bodies of a scene in a world of their own, with what a scene adds to physics: flippers on keys,
// bumpers that kick, bodies that start again when they have fallen off. One thread at a time.
//
// Bodies are numbered balls first, then the scene's other bodies, then the pen (which is not in the world).
#pragma once

#include <vector>

#include "dynamics/world.h"
#include "scene/scene.h"
#include "scene/surfaces.h"

namespace intaglio::scene {

// Bits of the keys that flippers listen to.
inline constexpr unsigned left_key = 1, right_key = 2;

class SceneWorld {
 public:
  SceneWorld(const Scene& scene, const SceneSurface& surface, Representation representation);

  dynamics::World& world() { return world_; }
  const dynamics::World& world() const { return world_; }
  // One physics step with these keys held.
  void step(unsigned keys = 0);
  // Everything as it was at the start, but for time.
  void reset();

  BodyId ball(std::size_t k) const { return static_cast<BodyId>(k + 1); }
  BodyId body(std::size_t k) const { return static_cast<BodyId>(balls_.size() + k + 1); }
  BodyId pen() const { return static_cast<BodyId>(balls_.size() + bodies_.size() + 1); }
  std::size_t count() const { return balls_.size() + bodies_.size(); }
  // As drawn: balls, then bodies.
  Pose pose(std::size_t k) const { return world_.drawn_pose(static_cast<BodyId>(k + 1)); }
  bool is_free(BodyId id) const;
  double mass(BodyId id) const;  // kg

  // Takes over where bodies are and how they move from the same scene's world of another kind.
  void follow(const SceneWorld& other);

 private:
  void turn_flippers(unsigned keys);
  void kick();
  void respawn();
  void put_back(std::size_t k);

  std::vector<BallSettings> balls_;
  std::vector<BodySettings> bodies_;
  std::optional<double> respawn_below_;
  double step_;
  std::vector<double> struck_;  // of each body's flipper, 0 rest to 1 struck
  dynamics::World world_;
};

}  // namespace intaglio::scene
