// Pictures of textured surfaces, with or without a screen: relief mapping with self-occlusion, self-shadow,
// true depth and cut silhouettes (Sterling & Lin 2016, §1.2.1).
//
//   auto renderer = intaglio::Renderer::headless(960, 540).value();
//   auto picture = renderer.draw({.surfaces = {wall}, .camera = {.eye = {0, 1, 2}}});
//   if (picture) picture->save("wall.png");                         // examples/picture.cpp
//
// OpenGL 3.3 by EGL, without a window; on a machine without a GPU Mesa draws it in software: about 0.2
// CPU-seconds a frame of 640 x 360. A Renderer has its own context, current only during a call, so any thread
// may use it, one at a time. Deterministic: the same driver and view give the same bytes. Metres, world
// frame; colours are linear RGB.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/image.h"
#include "intaglio/mesh.h"
#include "intaglio/representation.h"
#include "intaglio/surface.h"
#include "intaglio/triangle_mesh.h"
#include "intaglio/vec.h"

namespace intaglio {

struct Camera {
  Vec3 eye = Vec3(0, 0.6, 0.9);
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitY();       // in the picture; -Z if it is parallel to the view
  double fov_y_degrees = 45;     // whole vertical angle
  double near = 0.01, far = 50;  // m
};

struct Light {
  Vec3 direction = Vec3(-0.62, 0.50, -0.22);  // towards the sun; any length
  std::optional<Vec3> position = {};  // m: a lamp here instead of the sun; it does not fall off with distance
  double radius_degrees = 1.5;        // how large it looks: what makes shadows soft
  Vec3 colour = Vec3(3.2, 3.0, 2.7);
  Vec3 sky = Vec3(0.42, 0.50, 0.62);     // ambient light from above
  Vec3 ground = Vec3(0.16, 0.12, 0.10);  // and from below
};

// A curved surface, where its mesh says or moved from there.
struct DrawnCurved {
  CurvedSurface surface;
  Pose pose = {};
  double shadow_radius = 0;  // m: it casts the shadow of a ball about its pose; 0: none
};

struct DrawnBall {
  Pose pose = {};
  double radius = 0.04;
  // In alternating segments, so that rolling shows.
  Vec3 colour = Vec3(0.05, 0.24, 0.62), second_colour = Vec3(0.86, 0.84, 0.78);
};

// A body of any other shape, in one colour. Keep the mesh: it is uploaded once.
struct DrawnMesh {
  std::shared_ptr<const TriangleMesh> mesh;
  Pose pose = {};
  Vec3 colour = Vec3(0.62, 0.30, 0.10);
  double shadow_radius = 0;
};

struct DrawnPen {
  Vec3 tip = Vec3::Zero();
  Vec3 direction = Vec3::UnitY();  // from the tip up the shaft
  double length = 0.16, radius = 0.005;
};

struct View {
  std::vector<Surface> surfaces = {};  // the first one is where bodies cast their shadows
  std::vector<DrawnCurved> curved = {};
  std::vector<DrawnBall> balls = {};
  std::vector<DrawnMesh> meshes = {};
  std::optional<DrawnPen> pen = {};
  Camera camera = {};
  Light light = {};
  Representation representation = Representation::relief;
};

struct Picture {
  Image8 image;  // sRGB, 3 channels, row 0 at the top

  Result<void> save(const std::filesystem::path& path) const;  // as PNG; whole or not at all
};

struct RendererOptions {
  int supersample = 2;           // samples along a pixel's side, 1..4
  bool exact = true;             // the ray meets the exact relief; else the paper's linear and binary search
  int shadow_steps = 32;         // at most, of the self-shadow; 0: none
  double slab_thickness = 0.03;  // m below the base plane, drawn where a surface is cut
};

class Renderer {
 public:
  // Errors: no EGL or OpenGL 3.3, a picture larger than the driver allows.
  static Result<Renderer> headless(int width, int height, const RendererOptions& options = {});
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Uploads surfaces that are not those of the last view, so pass the same handles each time instead of
  // loading a texture again. Errors: nothing to draw, a texture larger than the driver allows.
  Result<Picture> draw(const View& view);
  // Linear depth of the last picture, row 0 at the top: metres along the camera's axis, infinite for the
  // background.
  std::vector<float> depth() const;
  std::string device() const;  // the driver

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace intaglio
