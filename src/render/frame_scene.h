// One picture's camera, light and bodies: plain values, filled in for every frame. The surfaces themselves
// are the renderer's (renderer.h). Metres, world frame; colours are linear RGB, 1 = white.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "intaglio/event.h"
#include "intaglio/representation.h"
#include "intaglio/vec.h"

namespace intaglio::render {

using intaglio::Representation;
struct Mesh;  // mesh.h

struct Camera {
  Vec3 eye = {0, 0.6, 0.9};
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitY();    // up in the picture; -Z when it is parallel to the view, as from straight above
  double fov_y_degrees = 45;  // full vertical field of view
  double near = 0.01;         // clip distances
  double far = 50;
};

// Unit axes of a camera: x right, y up, -z along the view.
struct CameraBasis {
  Vec3 right, up, back;
};
CameraBasis basis_of(const Camera& camera);

struct Light {
  Vec3 direction = Vec3(-0.62, 0.50, -0.22);  // towards the sun; any length
  std::optional<Vec3> position;  // a lamp here instead of the sun; it does not fall off with distance
  double radius_degrees = 1.5;   // angular radius: larger is softer shadows
  Vec3 colour = Vec3(3.2, 3.0, 2.7);
  Vec3 sky = Vec3(0.42, 0.50, 0.62);     // ambient light on a surface that faces up
  Vec3 ground = Vec3(0.16, 0.12, 0.10);  // and on one that faces down
};

struct Ball {
  Pose pose;
  double radius = 0.04;
  Vec3 colour = Vec3(0.05, 0.24, 0.62);  // alternating segments make rolling visible
  Vec3 second_colour = Vec3(0.86, 0.84, 0.78);
};

// A body of any other shape, in one colour.
struct Solid {
  Pose pose;
  std::shared_ptr<const Mesh> mesh;  // uploaded on first use, released when a frame no longer draws it
  Vec3 colour = Vec3(0.62, 0.30, 0.10);
  double shadow_radius = 0;  // m: it casts the shadow of a ball of this radius about its pose; 0: none
};

struct Pen {
  Vec3 tip = Vec3::Zero();
  Vec3 direction = Vec3::UnitY();  // from the tip up the shaft; any length
  double length = 0.16;
  double radius = 0.005;
  Vec3 colour = Vec3(0.03, 0.035, 0.045);
};

struct Background {
  Vec3 top = Vec3(0.016, 0.019, 0.026);
  Vec3 bottom = Vec3(0.060, 0.068, 0.084);
};

struct FrameScene {
  Camera camera;
  Light light;
  std::vector<Ball> balls;  // all are drawn; shadow_casters() in programs.h says which cast shadows
  std::vector<Solid> solids;
  std::optional<Pen> pen;
  Representation representation = Representation::relief;
  // Poses of the renderer's parts, in their order; identity where missing. Only curved parts move.
  struct PartPose {
    Pose pose;
    double shadow_radius = 0;  // see Solid
  };
  std::vector<PartPose> part_poses;
  Background background;
};

}  // namespace intaglio::render
