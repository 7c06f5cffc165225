// What one picture shows besides the surface: plain values that a session fills in for every frame. Metres,
// world frame; colours are linear RGB, 1 = white, unless said otherwise.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "intaglio/event.h"
#include "intaglio/representation.h"
#include "intaglio/vec.h"
#include "render/mesh.h"

namespace intaglio::render {

using intaglio::Representation;

struct Camera {
  Vec3 eye = {0, 0.6, 0.9};
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitY();  // up in the picture; -Z where it is along the view, as when looking straight down
  double fov_y_degrees = 45;  // whole vertical angle
  double near = 0.01;         // nothing nearer is drawn, nor anything farther than far
  double far = 50;
};

struct Light {
  Vec3 direction = Vec3(-0.62, 0.50, -0.22);  // towards the sun; any length
  std::optional<Vec3> position;  // a lamp here instead of the sun; it does not fall off with distance
  double radius_degrees = 1.5;   // how large it looks, half angle: what makes shadows soft
  Vec3 colour = Vec3(3.2, 3.0, 2.7);
  Vec3 sky = Vec3(0.42, 0.50, 0.62);     // ambient light from the side that the surface faces
  Vec3 ground = Vec3(0.16, 0.12, 0.10);  // and from the other side
};

struct Ball {
  Pose pose;
  double radius = 0.04;
  Vec3 colour = Vec3(0.05, 0.24, 0.62);  // two tones, in gores, so that rolling is seen
  Vec3 second_colour = Vec3(0.86, 0.84, 0.78);
};

// A body of any other shape, in one colour.
struct Solid {
  Pose pose;
  std::shared_ptr<const Mesh>
      mesh;  // uploaded when first drawn, and again forgotten when it is drawn no more
  Vec3 colour = Vec3(0.62, 0.30, 0.10);
  double shadow_radius = 0;  // m: it casts the shadow of a ball about its pose; 0: none
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
  std::vector<Ball> balls;  // all are drawn; the first 32, then solids, cast shadows on other things
  std::vector<Solid> solids;
  std::optional<Pen> pen;
  Representation representation = Representation::relief;
  // Where the renderer's curved parts are, one a part in their order; where their base was made, when none is
  // given.
  struct PartPose {
    Pose pose;
    double shadow_radius = 0;  // as of a solid
  };
  std::vector<PartPose> part_poses;
  Background background;
};

}  // namespace intaglio::render
