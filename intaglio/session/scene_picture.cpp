#include "intaglio/session/scene_picture.h"

#include <cmath>

#include "intaglio/contact/mass.h"
#include "intaglio/session/back_mesh.h"
#include "intaglio/session/shape_mesh.h"

namespace intaglio::session {

namespace {

// A box behind its reliefs, which reach 1 % below their depth.
render::Mesh core_mesh(const contact::Box& box, const std::vector<SceneSurface>& reliefs) {
  double low = -box.half.y(), high = box.half.y();
  for (const SceneSurface& relief : reliefs) {
    const double depth = 1.02 * relief.surface->max_depth();
    (relief.surface->placement().n().y() > 0 ? high : low) -=
        relief.surface->placement().n().y() > 0 ? depth : -depth;
  }
  render::Mesh mesh = shape_mesh(contact::Box{{box.half.x(), 0.5 * (high - low), box.half.z()}});
  for (render::Vertex& v : mesh.vertices) v.position[1] += static_cast<float>(0.5 * (low + high));
  return mesh;
}

}  // namespace

ScenePicture::ScenePicture(const Scene& scene, const SceneSurface& surface)
    : scene_(scene), part_poses_(1 + surface.grounds.size()) {
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    add_body(k, k < surface.reliefs.size() ? surface.reliefs[k] : std::vector<SceneSurface>());
  for (std::size_t k = 0; k < surface.grounds.size(); ++k) {
    const auto& curved = surface.grounds[k].curved;
    if (!curved) continue;
    render::Solid back;
    back.mesh = std::make_shared<const render::Mesh>(back_mesh(
        curved->base().mesh(), 1.01 * surface.grounds[k].surface->max_depth(), scene.grounds[k].thickness));
    back.colour = Vec3(0.20, 0.17, 0.14);
    if (!back.mesh->vertices.empty()) solids_.push_back(std::move(back));
  }
}

void ScenePicture::add_body(std::size_t k, const std::vector<SceneSurface>& reliefs) {
  const BodyScene& body = scene_.bodies[k];
  Drawn& drawn = drawn_.emplace_back();
  drawn.first_part = part_poses_.size();
  drawn.parts = reliefs.size();
  // The ball of its volume.
  const double shadow = 0.62 * std::cbrt(contact::mass_properties(body.body.shape).volume);
  const bool has_skin = !reliefs.empty() && reliefs.front().curved;
  for (std::size_t n = 0; n < reliefs.size(); ++n)
    part_poses_.push_back({body.body.pose, has_skin ? shadow : 0});
  if (has_skin) return;
  const auto* box = std::get_if<contact::Box>(&body.body.shape);
  const bool has_core =
      box != nullptr && !reliefs.empty() && scene_.surface.representation == Representation::relief;
  render::Solid solid;
  solid.pose = body.body.pose;
  solid.mesh =
      std::make_shared<const render::Mesh>(has_core ? core_mesh(*box, reliefs) : shape_mesh(body.body.shape));
  solid.colour = body.colour;
  solid.shadow_radius = shadow;
  drawn.solid = solids_.size();
  solids_.push_back(std::move(solid));
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
  frame.part_poses = part_poses_;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Drawn& drawn = drawn_[k];
    if (drawn.solid) frame.solids[*drawn.solid].pose = bodies[k];
    for (std::size_t n = 0; n < drawn.parts; ++n) frame.part_poses[drawn.first_part + n].pose = bodies[k];
  }
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
  std::vector<render::SurfacePart> parts;
  const auto add = [&](const SceneSurface& one, double thickness) {
    parts.push_back({.surface = one.surface.get(),
                     .slab_thickness = thickness,
                     .roughness = one.roughness,
                     .base = one.curved ? &one.curved->base().mesh() : one.quad.get()});
  };
  add(surface, scene.surface.thickness);
  for (std::size_t k = 0; k < surface.grounds.size(); ++k)
    add(surface.grounds[k], scene.grounds[k].thickness);
  for (const auto& reliefs : surface.reliefs)
    for (const SceneSurface& relief : reliefs) add(relief, 0.01);
  return parts;
}

}  // namespace intaglio::session
