// A scene file in memory: surfaces, bodies, pen, sound, video and camera. Keys, units and defaults:
// docs/scene.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dynamics/world.h"
#include "haptics/device.h"
#include "haptics/servo.h"
#include "intaglio/error.h"
#include "intaglio/event.h"
#include "intaglio/material.h"
#include "intaglio/memory.h"
#include "intaglio/representation.h"
#include "intaglio/vec.h"
#include "scene/cues.h"
#include "sound/synthesizer.h"
#include "surface/import.h"

namespace intaglio::scene {

// A curved base, over which the texture is repeated `repeat` times; without a base it covers a rectangle
// once.
struct BaseSettings {
  enum class Shape { bowl, cylinder, sphere, mesh };  // mesh/triangle_mesh.h, or a file
  Shape shape = Shape::bowl;
  double radius = 0.3, height = 0.5;  // m; height of a cylinder
  std::string file;                   // mesh file with texture coordinates; only for Shape::mesh
  Vec2 repeat = Vec2(1, 1);           // integers
  std::string line;                   // "file:line" in the scene file, for errors; empty: not from a file
};

struct SurfaceSettings {
  // A built-in name, a recipe (.toml), an image or a folder, relative to the working folder.
  std::string texture = "brick";
  std::optional<surface::Green> green;
  std::optional<surface::Polarity> polarity;
  surface::Edge edge = surface::Edge::wrap;
  Vec2 size = Vec2(1, 1);  // m
  std::optional<BaseSettings> base;
  std::optional<double> depth;  // m, depth of a full-depth texel; unset: derived from the texture
  surface::ImportMode mode = surface::ImportMode::fused;
  double thickness = 0.05;       // m, of the slab, heard and drawn
  Vec3 position = Vec3::Zero();  // m, centre
  Vec3 rotation = Vec3::Zero();  // degrees about X, then Y, then Z
  Representation representation = Representation::relief;
  std::optional<Material> material;  // unset: the built-in texture's own, otherwise brick
  std::string line;  // "file:line" of the texture in the scene file, for errors; empty: not from a file
};

struct PhysicsSettings {
  int rate = 480;  // Hz
  Vec3 gravity = Vec3(0, -9.81, 0);
  dynamics::ContactMethod method = dynamics::ContactMethod::closest;
  dynamics::NormalMethod normal_method = dynamics::NormalMethod::implied;
  std::optional<double> respawn_below;  // m; a body that falls below returns to its start
};

struct BallSettings : dynamics::SphereBody {
  std::optional<Vec3> colour;  // linear RGB; unset: the default two-tone pattern
};

// A pinball flipper: a driven body that turns about a pivot while its key is held.
struct Flipper {
  int key = 0;                // 0: the left key, 1: the right one
  Vec3 pivot = Vec3::Zero();  // m, in the body's frame
  Vec3 axis = Vec3::UnitY();  // in the body's frame
  double sweep = 50;          // degrees, from rest to fully raised; negative reverses the direction
};

struct BodySettings {
  std::string name;  // for reports: "box", "letter A"
  dynamics::ShapeBody body;
  std::vector<SurfaceSettings> reliefs;  // in its frame: top and bottom of a box, skin of a sphere
  Vec3 colour = Vec3(0.62, 0.30, 0.10);  // linear RGB
  double kick = 0;                       // m/s, added to a ball on contact (bumper); 0: none
  std::optional<Flipper> flipper;        // if set, the body's motion is driven
};

struct PenSettings {
  double length = 0.15, radius = 0.005;  // m
  Material material = *find_material("wood");
  Vec3 direction = Vec3(0.25, 1, 0.35);  // from the tip up the shaft, world
  haptics::WorkspaceMap workspace;
  haptics::HapticMethod method = haptics::HapticMethod::potential;
  std::optional<double> tip_radius;  // m, world; unset: 1 mm at the device, scaled by the workspace
  haptics::Spring spring;
  haptics::GuardLimits limits;
  haptics::DeviceModel device;
  haptics::Hand hand;
  std::vector<haptics::Waypoint> path;  // m, world; a session converts it to the device's workspace
};

struct SoundSettings {
  int sample_rate = 44100;  // Hz
  double gain_db = 0;
  std::optional<sound::MesoSource> meso;  // unset: chosen from the representation
  double micro = 1;                       // level of the fractal noise, relative to the default; 0: off
  int modes = 120;                        // maximum, per body
};

struct VideoSettings {
  int width = 640, height = 360, fps = 30;
  int supersample = 2;  // samples per pixel side
};

struct CameraSettings {
  Vec3 eye = Vec3(0.2, 0.62, 0.92), target = Vec3(0, -0.02, 0.02);
  double vertical_fov = 38;  // degrees
};

struct Scene {
  std::string name;  // path of the scene file, for messages
  std::string title = "Untitled";
  double duration = 8;  // s
  int seed = 1;
  SurfaceSettings surface;
  PhysicsSettings physics;
  std::vector<SurfaceSettings> grounds;  // static textured surfaces besides the floor
  std::vector<BallSettings> balls;
  std::vector<BodySettings> bodies;
  std::optional<PenSettings> pen;
  SoundSettings sound;
  VideoSettings video;
  CameraSettings camera;
  Vec3 light = Vec3(-0.55, 0.75, -0.35);  // towards the light
  Cues cues;                              // what each sense is given
  // Bytes (cost.h); no key of a scene file, which must not raise its own budget.
  std::uint64_t allowed_memory = default_allowed_memory;

  // Bodies are numbered from 1: balls, then the other bodies, then the pen.
  static BodyId ball_id(std::size_t k) { return BodyId(k + 1); }
  BodyId body_id(std::size_t k) const { return BodyId(balls.size() + k + 1); }
  BodyId pen_id() const { return body_id(bodies.size()); }
};

// Rotation about X, then Y, then Z, world axes.
Quat rotation_of(const Vec3& degrees);

// Replaces the texture and clears the settings that belonged to the old one (depth, signs, line).
void put_texture(SurfaceSettings& surface, const std::string& texture);

// Reads a scene from text; `name` is used as the file name in errors. `allowed_memory` becomes the scene's.
Result<Scene> parse_scene(std::string_view text, const std::string& name);
Result<Scene> read_scene(const std::filesystem::path& path,
                         std::uint64_t allowed_memory = default_allowed_memory);

}  // namespace intaglio::scene
