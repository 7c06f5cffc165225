// The camera that a mouse and keys move: round a target (orbit), or as one looks (fly). Pure; metres,
// radians.
#pragma once

#include <optional>
#include <span>

#include "mesh/triangle_mesh.h"
#include "render/frame_scene.h"
#include "scene/scene.h"
#include "surface/surface.h"

namespace intaglio::window {

class ViewCamera {
 public:
  // As the scene's camera looks at the start; home() goes back there.
  explicit ViewCamera(const render::Camera& start);

  // `across` and `up` in parts of the picture's height.
  void orbit(double across, double up);  // round the target
  void look(double across, double up);   // from where it is
  void pan(double across, double up);    // what is under the mouse stays under it
  void zoom(double notches);             // towards the target, a tenth of the way a notch
  void fly(const Vec3& step);            // right, up, ahead; in distances to the target
  void home() { *this = ViewCamera(start_); }

  const render::Camera& camera() const { return camera_; }

 private:
  Vec3 ahead() const { return (camera_.target - camera_.eye).normalized(); }
  Vec3 right() const { return ahead().cross(Vec3::UnitY()).normalized(); }
  double distance() const { return (camera_.target - camera_.eye).norm(); }
  // A direction turned by the mouse, never quite up or down.
  Vec3 turned(const Vec3& direction, double across, double up) const;

  render::Camera start_, camera_;
};

// A world point in the picture: x to the right, y down, 0..1; not in front of the camera: nothing. And the
// ray through such a place, from the eye.
struct Projection {
  Projection(const render::Camera& camera, double aspect);

  std::optional<Vec2> project(const Vec3& world) const;
  Vec3 ray(const Vec2& place) const;  // unit

  Vec3 eye, right, up, ahead;
  double tangent, aspect, near;  // tangent of half the vertical angle
};

// What is under the mouse: a body, or a place of the floor. Pure.

struct Picked {
  BodyId body = floor_body;   // the floor: none
  Vec3 point = Vec3::Zero();  // where the ray meets it, world
  double distance = 0;        // m along the ray
};

// The nearest body on the ray (`direction` unit). Balls exactly; other bodies by the balls or boxes that they
// are made of.
std::optional<Picked> pick_body(const scene::Scene& scene, std::span<const Pose> poses, const Vec3& origin,
                                const Vec3& direction);

// Where the ray meets the floor's relief, or, beside the rectangle, its base plane.
std::optional<Vec3> pick_floor(const surface::Surface& floor, bool has_relief, const Vec3& origin,
                               const Vec3& direction);

// Where the ray meets the front of a curved base, with the normal there.
struct PickedBase {
  Vec3 point, normal;
};
std::optional<PickedBase> pick_base(const surface::TriangleMesh& base, const Vec3& origin,
                                    const Vec3& direction);

}  // namespace intaglio::window
