#include "intaglio/session/scene_picture.h"

#include <cmath>

#include "intaglio/contact/mass.h"
#include "intaglio/session/shape_mesh.h"

namespace intaglio::session {

ScenePicture::ScenePicture(const Scene& scene) : scene_(scene) {
  for (const BodyScene& body : scene.bodies) {
    render::Solid solid;
    solid.pose = body.body.pose;
    solid.mesh = std::make_shared<const render::Mesh>(shape_mesh(body.body.shape));
    solid.colour = body.colour;
    // The ball of its volume.
    solid.shadow_radius = 0.62 * std::cbrt(contact::mass_properties(body.body.shape).volume);
    solids_.push_back(std::move(solid));
  }
}

render::FrameScene ScenePicture::frame(std::span<const Pose> balls, std::span<const Pose> bodies,
                                       const std::optional<Vec3>& pen_tip) const {
  render::FrameScene frame;
  frame.camera.eye = scene_.camera.eye;
  frame.camera.target = scene_.camera.target;
  frame.camera.fov_y_degrees = scene_.camera.vertical_fov;
  frame.light.direction = scene_.light;
  frame.representation = scene_.surface.representation;
  for (std::size_t k = 0; k < balls.size(); ++k) {
    render::Ball ball;
    ball.pose = balls[k];
    ball.radius = scene_.balls[k].radius;
    if (scene_.balls[k].colour) ball.colour = *scene_.balls[k].colour;
    frame.balls.push_back(ball);
  }
  frame.solids = solids_;
  for (std::size_t k = 0; k < bodies.size(); ++k) frame.solids[k].pose = bodies[k];
  if (pen_tip && scene_.pen) {
    render::Pen pen;
    pen.tip = *pen_tip;
    pen.direction = scene_.pen->direction;
    pen.length = scene_.pen->length;
    pen.radius = scene_.pen->radius;
    frame.pen = pen;
  }
  return frame;
}

std::vector<render::SurfacePart> surface_parts(const Scene& scene, const SceneSurface& surface) {
  std::vector<render::SurfacePart> parts = {
      {surface.surface.get(), scene.surface.thickness, surface.roughness}};
  for (std::size_t k = 0; k < surface.grounds.size(); ++k)
    parts.push_back(
        {surface.grounds[k].surface.get(), scene.grounds[k].thickness, surface.grounds[k].roughness});
  return parts;
}

}  // namespace intaglio::session
