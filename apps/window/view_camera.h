// The camera that the mouse and keys move, the projection of its picture, and picking in that picture. Pure;
// metres, radians.
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
  // home() goes back to `start`.
  explicit ViewCamera(const render::Camera& start);

  // dx to the right and dy up, in fractions of the picture's height.
  void orbit(double dx, double dy);  // around the target
  void look(double dx, double dy);   // around the eye
  void pan(double dx, double dy);    // the target moves with the mouse
  void zoom(double notches);         // towards the target, a tenth of the way a notch
  void fly(const Vec3& step);        // right, up, forward; in units of the distance to the target
  void home() { *this = ViewCamera(start_); }

  const render::Camera& camera() const { return camera_; }

 private:
  Vec3 forward() const { return (camera_.target - camera_.eye).normalized(); }
  Vec3 right() const { return forward().cross(Vec3::UnitY()).normalized(); }
  double distance() const { return (camera_.target - camera_.eye).norm(); }
  // A direction rotated by the mouse, never quite to vertical.
  Vec3 rotated(const Vec3& direction, double dx, double dy) const;

  render::Camera start_, camera_;
};

// From the world to the picture (x to the right, y down, 0..1) and back.
struct Projection {
  Projection(const render::Camera& camera, double aspect);

  std::optional<Vec2> project(const Vec3& world) const;  // nullopt behind the near plane
  Vec3 ray(const Vec2& place) const;                     // unit, from the eye

  Vec3 eye, right, up, forward;
  double tan_half_fov, aspect, near;  // tangent of half the vertical angle
};

struct Picked {
  BodyId body = floor_body;   // the floor: none
  Vec3 point = Vec3::Zero();  // on the ray, world
  double distance = 0;        // m along the ray
};

// The nearest body on the ray (`direction` unit): balls exactly, other bodies approximated by spheres and
// boxes.
std::optional<Picked> pick_body(const scene::Scene& scene, std::span<const Pose> poses, const Vec3& origin,
                                const Vec3& direction);

// Where the ray meets the floor's relief, or its base plane outside the rectangle.
std::optional<Vec3> pick_floor(const surface::Surface& floor, bool use_relief, const Vec3& origin,
                               const Vec3& direction);

struct PickedBase {
  Vec3 point, normal;
};
// Where the ray meets the front of a curved base.
std::optional<PickedBase> pick_base(const surface::TriangleMesh& base, const Vec3& origin,
                                    const Vec3& direction);

}  // namespace intaglio::window
