// The part of ClosestSearch that looks at the four blocks of a quad.
#include <cmath>
#include <limits>

#include "intaglio/surface/closest_search.h"

namespace intaglio::surface {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Outside the cones of features already found, up to which level slabs are asked; for the nearest point level
// 0 is enough (measured).
constexpr int slab_levels = 4;

template <class T>
std::array<double, 4> doubles(const Four<T>& four) {
  return {four[0], four[1], four[2], four[3]};
}

}  // namespace

// Where the blocks of a quad are in plan; and whether some stand for everything beyond the border.
template <class T>
void ClosestSearch::lay_out(const Entry& entry, Boxes<T>& boxes, bool& at_border) const {
  const int side = Pyramid::side(entry.level);
  const double width = side * w_, height = side * h_;
  std::array<double, 3> x, y;
  x[0] = origin_x_ + 2 * entry.x * width;
  y[0] = origin_y_ + 2 * entry.y * height;
  x[1] = x[0] + width;
  y[1] = y[0] + height;
  x[2] = x[1] + width;
  y[2] = y[1] + height;
  at_border = false;
  if (surface_.edge() == Edge::clamp) {
    // The outermost blocks go on for ever.
    if (entry.x == 0) x[0] = -infinity;
    if (entry.y == 0) y[0] = -infinity;
    for (int k = 1; k < 3; ++k) {
      if ((2 * entry.x + k) * side >= pyramid_.columns()) x[std::size_t(k)] = infinity;
      if ((2 * entry.y + k) * side >= pyramid_.rows()) y[std::size_t(k)] = infinity;
    }
    at_border = std::isinf(x[0]) || std::isinf(y[0]) || std::isinf(x[2]) || std::isinf(y[2]);
  }
  const auto t = [](double value) { return static_cast<T>(value); };
  boxes.x0 = Four<T>(t(x[0]), t(x[1]), t(x[0]), t(x[1]));
  boxes.x1 = Four<T>(t(x[1]), t(x[2]), t(x[1]), t(x[2]));
  boxes.y0 = Four<T>(t(y[0]), t(y[0]), t(y[1]), t(y[1]));
  boxes.y1 = Four<T>(t(y[1]), t(y[1]), t(y[2]), t(y[2]));
}

// The slabs of a quad's blocks.
template <class T>
TiltedPieces<T> ClosestSearch::planes_of(const Entry& entry, const Boxes<T>& boxes) const {
  const Pyramid::Slabs4& slabs = pyramid_.slabs(entry.level, entry.x, entry.y);
  const T depth = static_cast<T>(surface_.max_depth()), unit = static_cast<T>(Pyramid::depth_unit),
          slope_unit = depth * static_cast<T>(Pyramid::slope_unit);
  const auto w = static_cast<T>(w_), h = static_cast<T>(h_);
  const int side = Pyramid::side(entry.level);
  Four<T> low, high, slope_x, slope_y;
  for (int k = 0; k < 4; ++k) {
    low[k] = slabs.low[std::size_t(k)];
    high[k] = slabs.high[std::size_t(k)];
    slope_x[k] = slabs.slope_x[std::size_t(k)];
    slope_y[k] = slabs.slope_y[std::size_t(k)];
  }
  return {T(0.5) * (boxes.x0 + boxes.x1),
          T(0.5) * (boxes.y0 + boxes.y1),
          -(T(0.5) * depth * unit) * (low + high) - static_cast<T>(asking_.z()),
          -(slope_unit / w) * slope_x,
          -(slope_unit / h) * slope_y,
          (T(0.5) * depth * unit) * (high - low) + height_loss<T>(),
          static_cast<T>(side) * w,
          static_cast<T>(side) * h};
}

// How much the slopes of the relief differ from those of the slabs.
template <class T>
std::array<Four<T>, 2> ClosestSearch::spreads_of(const Entry& entry) const {
  const Pyramid::Slabs4& slabs = pyramid_.slabs(entry.level, entry.x, entry.y);
  Four<T> x, y;
  for (int k = 0; k < 4; ++k) {
    x[k] = slabs.spread_x[std::size_t(k)];
    y[k] = slabs.spread_y[std::size_t(k)];
  }
  const double unit = surface_.max_depth() * pyramid_.spread_unit();
  return {static_cast<T>(unit / w_) * x, static_cast<T>(unit / h_) * y};
}

// Which of a quad's blocks there are.
unsigned ClosestSearch::existing(const Entry& entry) const {
  const int side = Pyramid::side(entry.level);
  unsigned out = 0xf;
  if ((2 * entry.x + 1) * side >= pyramid_.columns()) out &= 0x5;
  if ((2 * entry.y + 1) * side >= pyramid_.rows()) out &= 0x3;
  return out;
}

// Which of the blocks may hold something wanted, and how near.
template <class T>
ClosestSearch::Seen ClosestSearch::look_at(const Entry& entry) const {
  Boxes<T> boxes;
  bool at_border;
  lay_out(entry, boxes, at_border);
  TiltedPieces<T> planes;
  const bool tilts = entry.level == 0 || (!cones_.empty() && entry.level <= slab_levels && !at_border);
  if (tilts) planes = planes_of(entry, boxes);
  if (entry.level > 0) {
    const Pyramid::Bounds4 quad = pyramid_.quad(entry.level, entry.x, entry.y);
    const T depth = static_cast<T>(surface_.max_depth()), z = static_cast<T>(asking_.z());
    using Floats = Eigen::Map<const Four<float>>;
    boxes.z0 = -depth * Floats(quad.deep.data()).template cast<T>() - (z + height_loss<T>());
    boxes.z1 = -depth * Floats(quad.shallow.data()).template cast<T>() - (z - height_loss<T>());
  } else {
    const Four<T> thick = planes.thickness();
    boxes.z0 = planes.z - thick;
    boxes.z1 = planes.z + thick;
  }
  const T limit = static_cast<T>(wanted()) * (1 + loss<T>);
  const Four<T> limit2 = Four<T>::Constant(limit * limit);
  Four<T> bound2 = boxes.least_distance2();
  unsigned open = entry.blocks & existing(entry) & less<T>(bound2, limit2);
  if (tilts && !at_border && open != 0) {
    bound2 = bound2.max(planes.least_distance2());
    open &= less<T>(bound2, limit2);
  }
  if (!cones_.empty() && open != 0) {
    const Reached<T> reached(boxes, limit);
    for (std::size_t k = 0; k < cones_.size() && open != 0; ++k) {
      const Vec3 axis = cones_.axis(k);
      if (entry.level > 0) open &= ~reached.boxes_in_cone(axis, cones_.cosine());
      if (tilts && !at_border) open &= ~reached.planes_in_cone(planes, axis, cones_.cosine());
    }
    if (tilts && !at_border && open != 0) {
      const auto [x, y] = spreads_of<T>(entry);
      open &= ~planes.without_minimum(x, y);
    }
  }
  return {doubles(bound2), open};
}

template ClosestSearch::Seen ClosestSearch::look_at<float>(const Entry&) const;
template ClosestSearch::Seen ClosestSearch::look_at<double>(const Entry&) const;

}  // namespace intaglio::surface
