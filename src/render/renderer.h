// The picture of one textured surface, drawn headless: relief mapping with self-occlusion, self-shadow, cut
// silhouettes and true depth (Policarpo, Oliveira & Comba 2005; §1.2.1), with balls and a pen in the same
// depth buffer and light.
//
// The shader mirrors surface::Surface: same texel centres, same bilinear patches, same edge rule; tests hold
// the two together. The relief lies in the rectangle of the surface's placement, on a slab whose sides are
// drawn where they are cut.
//
// Thread: any, one at a time; a renderer has its own GL context, current in the caller's thread during a call
// only, unless it is told to use the caller's: that of a window. Deterministic: the same driver, surface and
// scene give the same bytes. Cost: about 0.2 CPU-seconds for a frame of 640 x 360 with supersample 2 on
// llvmpipe, and 0.2 to create.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/image.h"
#include "mesh/triangle_mesh.h"
#include "render/frame_scene.h"
#include "surface/surface.h"

namespace intaglio::render {

// How a view ray finds the relief: the paper's linear and binary search, or the exact one through the
// pyramid.
enum class March { classic, pyramid };

// What of the relief a sample meets that is larger than texels: the means of what it covers, as of colours
// and normals (surface_textures.h), or the one texel in its middle. Texels that are larger than samples are met
// as they are.
enum class Detail { by_footprint, every_texel };

// Whose OpenGL 3.3 core context is drawn with.
enum class Context {
  own,      // one without a window (egl_context.h)
  callers,  // the one that is current in the caller's thread, the same at every call and at destruction
};

// One textured rectangle of the picture, where its placement says.
struct SurfacePart {
  const surface::Surface* surface = nullptr;  // uploaded by the call that it is given to
  double slab_thickness = 0.03;
  double roughness = 0.55;
  // Not null: the relief lies on this curved base instead (`checked`; the surface's rectangle is then only
  // the measure of its u and v), which FrameScene::part_poses may move. Read by the call that it is given to.
  const surface::TriangleMesh* base = nullptr;
  int mesh_cells =
      0;  // over 0: relief is a displaced mesh of so many squares a side (mesh.h), for comparison
};

struct RendererOptions {
  int width = 1280;
  int height = 720;
  int supersample = 2;  // samples along a pixel's side, 1..4
  March march = March::pyramid;
  Detail detail = Detail::by_footprint;
  int linear_steps = 32;  // classic: linear steps
  int binary_steps = 6;   // classic: halvings after them
  int shadow_steps = 32;  // the most steps of the self-shadow, one a texel where that suffices; 0: none
  double slab_thickness =
      0.03;                 // metres below the base plane; raised to 1.25 times the relief's depth where less
  double roughness = 0.55;  // of the surface, 0..1 (GGX: the square is the slope's spread)
  Vec3 colour = Vec3(0.45, 0.44, 0.42);  // of the surface where it has no colour map; linear RGB
  Context context = Context::own;
  int mesh_cells = 0;  // see SurfacePart
};

class Renderer {
 public:
  // Uploads the surface; it need not outlive the call. Fails without EGL or OpenGL 3.3, with options out of
  // range, or when a texture or picture is larger than the driver allows.
  static Result<std::unique_ptr<Renderer>> create(const surface::Surface& surface,
                                                  const RendererOptions& options);
  ~Renderer();

  // Draws these surfaces from now on; the first one is where bodies get their shadows from. At least one. On
  // failure what was shown before stays.
  Result<void> show(std::span<const SurfacePart> parts);
  // Draws with the shaders of a folder (programs.h) from now on; when one does not compile, the error
  // names its file and line, and pictures stay as they were.
  Result<void> reload_shaders(const std::filesystem::path& folder);
  // The size of pictures from now on; on failure it stays as it was.
  Result<void> resize(int width, int height);

  // The picture: sRGB, 3 channels, row 0 at the top.
  Image8 draw(const FrameScene& scene);
  // Draws into the lower left width x height pixels of a framebuffer of the context (0: the window),
  // stretched when the picture has another size. Leaves that framebuffer bound, with nothing enabled.
  void draw_to(const FrameScene& scene, unsigned framebuffer, int width, int height);
  // The last picture again, at a size of its own: what a recording wants of a window that may be resized.
  Result<Image8> capture(int width, int height);

  // Linear depth of the last draw, width x height, row 0 at the top: metres from the eye along the camera's
  // axis (not along the pixel's ray), infinity where only the background is seen. A pixel has the depth of
  // its middle sample; with an even supersample, of the one right above the middle, half a sample away.
  std::vector<float> depth() const;

  // What the surfaces take of the device's memory; colour maps count as textures.
  struct DeviceBytes {
    std::size_t textures = 0, meshes = 0;
  };
  DeviceBytes device_bytes() const;

  // The driver, for logs and reports.
  std::string device() const;

 private:
  struct Gpu;
  explicit Renderer(std::unique_ptr<Gpu> gpu);

  std::unique_ptr<Gpu> gpu_;
};

}  // namespace intaglio::render
