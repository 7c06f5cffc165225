// How true a representation's pictures are, seen from above, at a slant and at a grazing angle.
//
// The views look at the whole slab from 75, 40 and 12 degrees above the horizon, under the scene's sun with
// shadows, in pictures of 16:9 with two samples a pixel's side.
//
// The reference has two forms. Its depth is found by brute force: rays, some 96 x 54 a picture, are walked
// over Reference::height in steps of half its grid, then bisected. Rays that meet a side of the slab do not
// count, nor those within half a sample of an edge that hides something: there either depth is right, and a
// few such pixels would be all of the error. Its picture and outline are those of a mesh of 1024 cells a
// side with the reference's heights and normals, drawn by rasterisation with the renderer's light, not by a
// march; its cells are smaller than the samples of pictures up to 480 pixels.
//
// A mesh is drawn with the reference's heights and normals at its vertices, and with the shadows of the whole
// reference, as from a perfect shadow map, which favours its FLIP: brick's mesh of 512 cells has 0.02 so, and
// 0.08 when the texture gives heights, normals and shadows. The others are drawn from their texture of 512
// texels, shadows as well.
//
// Needs EGL. One thread at a time. On llvmpipe a PictureReference takes 1.3 to 1.6 CPU seconds, a
// representation 0.3 to 1 at 480 pixels and 0.2 to 0.5 at 256, without its Sight.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "evaluate/sight.h"
#include "evaluate/subject.h"
#include "intaglio/image.h"
#include "render/frame_scene.h"

namespace intaglio::evaluate {

struct PictureTruth {
  // Root mean square over all views and pixels at which both see a surface, the reference its top; along the
  // camera's axis. A representation without relief lies in the base plane.
  double depth_mm = 0;
  // Degrees, mean over a grid of points, between the normals that Sight shows and the reference's. Both
  // slopes are means over squares of two texels of a 512 texture, so that no representation fails for
  // detail that none resolves; the reference's slopes saturate where Sight's do.
  double normal_angle = 0;
  // In the grazing view: pixels at which one picture alone shows the slab, as a fraction of those at which
  // either does.
  double silhouette = 0;
  double flip = 0;               // mean over all views and pixels at which either picture shows the slab
  std::size_t device_bytes = 0;  // Renderer::device_bytes(): textures and meshes
};

struct Picture {
  Image8 image;
  std::vector<float> depth;  // as Renderer::depth()
};

// Depths of rays through some pixels of a picture: every `stride`th along both axes from stride / 2 on, at
// the sample of which Renderer::depth() tells.
struct DepthGrid {
  int width = 0, height = 0;  // of the picture, pixels
  int supersample = 1, stride = 1;

  int columns() const { return (width - stride / 2 - 1) / stride + 1; }
  int rows() const { return (height - stride / 2 - 1) / stride + 1; }
  // Index of a grid point's pixel in the picture.
  std::size_t pixel(int column, int row) const {
    return std::size_t(row * stride + stride / 2) * std::size_t(width) +
           std::size_t(column * stride + stride / 2);
  }
};
// By brute force, row by row; m along the camera's axis. Infinity where the ray misses the reference's top,
// and where the depth jumps within half a sample: where two opposite rays of the sample's corners have a mean
// that is off by a tenth of the relief's depth and a thousandth of its side. Five rays, of 20 microseconds if
// they graze, 5 if they are steep.
std::vector<double> reference_depths(const Reference& reference, const surface::Placement& placement,
                                     const render::Camera& camera, const DepthGrid& grid);

// The pictures and depths with which all representations of a subject are compared.
class PictureReference {
 public:
  // `pixels`: width of the pictures, at least 64.
  static Result<PictureReference> make(const Subject& subject, int pixels);

  const DepthGrid& grid() const { return grid_; }
  // Steep to grazing.
  std::span<const render::Camera> views() const { return views_; }
  std::span<const Picture> pictures() const { return pictures_; }
  std::span<const std::vector<double>> depths() const { return depths_; }
  // The surface to draw: that of a mesh has the reference's heights, as its vertices have; another
  // representation's is the subject's own.
  const surface::Surface& drawn(const Subject& subject, const Candidate& candidate) const;

  // A picture a view, as pictures(). Sets depth, silhouette and flip.
  Result<PictureTruth> compare(std::span<const Picture> pictures) const;

 private:
  DepthGrid grid_;
  std::vector<render::Camera> views_;
  std::vector<Picture> pictures_;
  std::vector<std::vector<double>> depths_;
  std::shared_ptr<const surface::Surface> surface_;
};

// See PictureTruth::normal_angle.
double normal_angle(const Reference& reference, const Sight& sight);

// `sight`: of the same subject and candidate.
Result<PictureTruth> measure_picture(const Subject& subject, const Candidate& candidate, const Sight& sight,
                                     const PictureReference& reference);

}  // namespace intaglio::evaluate
