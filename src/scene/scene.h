// A scene: everything a session needs to know, read from a TOML file. Every key, unit and default:
// docs/scene.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/material.h"
#include "core/event.h"
#include "core/vec.h"
#include "dynamics/world.h"
#include "haptics/device.h"
#include "haptics/servo.h"
#include "sound/synthesizer.h"
#include "surface/import.h"

namespace intaglio::scene {

// A curved base that a texture goes over `repeat` times, instead of once over a rectangle.
struct BaseSettings {
  enum class Shape { bowl, cylinder, sphere, mesh };  // surface/mesh/mesh_shapes.h, or a file
  Shape shape = Shape::bowl;
  double radius = 0.3, height = 0.5;  // m; the height of a cylinder
  std::string file;                   // of a mesh with texture coordinates
  Vec2 repeat = Vec2(1, 1);           // whole numbers
  std::string line;                   // "file:line" in the scene file, for errors; empty: not from a file
};

struct SurfaceSettings {
  std::string texture =
      "brick";  // a built-in name, a recipe (.toml), an image or a folder, relative to the working folder
  std::optional<surface::Green> green;
  std::optional<surface::Polarity> polarity;
  surface::Edge edge = surface::Edge::wrap;
  Vec2 size = Vec2(1, 1);  // m
  std::optional<BaseSettings> base;
  std::optional<double> depth;  // m, of a full-depth texel; unset: what the texture itself implies
  surface::ImportMode mode = surface::ImportMode::fused;
  double thickness = 0.05;       // m, of the slab that rings and is drawn
  Vec3 position = Vec3::Zero();  // m, of the middle
  Vec3 rotation = Vec3::Zero();  // degrees about X, then Y, then Z
  Representation representation = Representation::relief;
  std::optional<Material> material;  // unset: the built-in texture's own, else brick
  std::string line;  // "file:line" of the texture in the scene file, for errors; empty: not from a file
};

struct PhysicsSettings {
  int rate = 480;  // Hz
  Vec3 gravity = Vec3(0, -9.81, 0);
  dynamics::ContactMethod method = dynamics::ContactMethod::closest;
  dynamics::NormalMethod normal_method = dynamics::NormalMethod::implied;
  std::optional<double> respawn_below;  // m: what falls below starts again where it began
};

struct BallSettings : dynamics::SphereBody {
  std::optional<Vec3> colour;  // linear RGB; unset: the usual two tones
};

// A driven body that turns about a pivot while a key is held: the pinball's.
struct Flipper {
  int key = 0;                // 0: the left key, 1: the right one
  Vec3 pivot = Vec3::Zero();  // m, in the body's frame
  Vec3 axis = Vec3::UnitY();  // in the body's frame
  double sweep = 50;          // degrees, from rest to struck; negative the other way
};

struct BodySettings {
  std::string name;  // for reports: "box", "letter A"
  dynamics::ShapeBody body;
  std::vector<SurfaceSettings>
      reliefs;  // on it, in its frame: of a box its top and bottom, of a ball its skin
  Vec3 colour = Vec3(0.62, 0.30, 0.10);  // linear RGB
  double kick = 0;                       // m/s that it adds to a ball that touches it: a bumper
  std::optional<Flipper> flipper;        // then its motion is driven
};

struct PenSettings {
  double length = 0.15, radius = 0.005;  // m
  Material material = *find_material("wood");
  Vec3 direction = Vec3(0.25, 1, 0.35);  // from the tip up the shaft, world
  haptics::WorkspaceMap workspace;
  haptics::HapticMethod method = haptics::HapticMethod::potential;
  std::optional<double> tip_radius;  // m, world; unset: 1 mm at the device
  haptics::Spring spring;
  haptics::GuardLimits limits;
  haptics::DeviceModel device;
  haptics::Hand hand;
  std::vector<haptics::Waypoint>
      path;  // world metres; turned into the device's workspace when the pen is made
};

struct SoundSettings {
  int sample_rate = 44100;  // Hz
  double gain_db = 0;
  std::optional<sound::MesoSource> meso;  // unset: what suits the representation
  double micro = 1;                       // level of the fractal noise, of the default's; 0 = off
  int modes = 120;                        // at most, of each body
};

struct VideoSettings {
  int width = 640, height = 360, fps = 30;
  int supersample = 2;  // samples along a side of a pixel
};

struct CameraSettings {
  Vec3 eye = Vec3(0.2, 0.62, 0.92), target = Vec3(0, -0.02, 0.02);
  double vertical_fov = 38;  // degrees
};

struct Scene {
  std::string name;  // of the file
  std::string title = "Untitled";
  double duration = 8;  // s
  int seed = 1;
  SurfaceSettings surface;
  PhysicsSettings physics;
  std::vector<SurfaceSettings> grounds;  // textured surfaces beside the floor, which do not move
  std::vector<BallSettings> balls;
  std::vector<BodySettings> bodies;
  std::optional<PenSettings> pen;
  SoundSettings sound;
  VideoSettings video;
  CameraSettings camera;
  Vec3 light = Vec3(-0.55, 0.75, -0.35);  // towards the light
};

// About X, then Y, then Z.
Quat rotation_of(const Vec3& degrees);

// Another texture there: what the scene file said of its own (depth, signs, line) goes with that.
void put_texture(SurfaceSettings& surface, const std::string& texture);

// Reads a scene from text; `name` stands for the file in errors.
Result<Scene> parse_scene(std::string_view text, const std::string& name);
Result<Scene> read_scene(const std::filesystem::path& path);

}  // namespace intaglio::scene
