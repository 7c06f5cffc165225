// The true relief of a texture, and what a ball or a tip that rests on it touches, by brute force.
//
// Independent of the code that is judged: no texels, no pyramid, no closest-feature search, no fused maps. A
// built-in material's relief is its recipe's analytic field, sampled on a fine grid; an image's is the
// bicubic field of its fused height, because an image has no other truth. Between the grid's points the
// relief is bicubic (Catmull-Rom). Local coordinates of surface/surface.h: metres, z = -depth; the relief
// repeats.
//
// Immutable; any thread. rest_on() costs (2 radius / spacing)^2 points of the grid.
#pragma once

#include <memory>
#include <vector>

#include "intaglio/vec.h"
#include "surface/recipes/recipe.h"
#include "surface/surface.h"

namespace intaglio::evaluate {

// A ball that touches the relief from above.
struct RestingBall {
  double z = 0;               // m, of its lowest point
  Vec3 touch = Vec3::Zero();  // m, the point of the relief that it touches
  Vec2 slope = Vec2::Zero();  // dz/dx, dz/dy of the height at which it rests
};

// The nearest point of the relief to a ball's centre.
struct Nearest {
  Vec3 point = Vec3::Zero();  // m
  double distance = 0;        // m, from the centre
};

class Reference {
 public:
  // A recipe's field over a rectangle of `size` metres, `depth` metres deep, sampled `grid` times a side.
  Reference(const surface::Recipe& recipe, const Vec2& size, double depth, int grid);
  // The bicubic field of a surface that was imported from images.
  Reference(const surface::Surface& surface, int grid);

  int grid() const { return n_; }
  const Vec2& size() const { return size_; }
  double depth() const { return depth_; }           // m
  const Vec2& spacing() const { return spacing_; }  // m
  // z of the relief; m.
  double height(const Vec2& p) const;
  Vec2 slope(const Vec2& p) const;
  // Mean height below the base, m.
  double mean() const { return mean_; }
  // z of the grid's point (i, j), which lies at ((i + 0.5) spacing_x, (j + 0.5) spacing_y); the grid repeats.
  double at(int i, int j) const { return z_[std::size_t(wrap(j)) * std::size_t(n_) + std::size_t(wrap(i))]; }

  // Where a ball of that radius rests whose centre is over p.
  RestingBall rest_on(const Vec2& p, double radius) const;
  // The parts of the relief nearer than `reach` to a ball's centre: local minima of the distance, nearest
  // first, at most eight.
  std::vector<Nearest> nearest(const Vec3& centre, double reach) const;

 private:
  // The grid's point that a ball over p touches first.
  Vec2 highest_point(const Vec2& p, double radius) const;
  int wrap(int k) const { return k >= 0 && k < n_ ? k : ((k % n_) + n_) % n_; }
  void measure_mean();

  int n_;
  Vec2 size_, spacing_;
  double depth_, mean_ = 0;
  std::vector<float> z_;  // m
};

// The reference of what a texture's name means: a recipe, or images. `surface` is the relief that was made
// of it at the wanted size and depth.
Result<std::shared_ptr<const Reference>> make_reference(const std::string& texture,
                                                        const surface::Surface& surface, int grid);

}  // namespace intaglio::evaluate
