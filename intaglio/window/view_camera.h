// The camera that a mouse and keys move: round a target (orbit), or as one looks (fly). Pure; metres,
// radians.
#pragma once

#include "intaglio/render/frame_scene.h"

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

}  // namespace intaglio::window
