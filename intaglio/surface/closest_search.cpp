#include "intaglio/surface/closest_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace intaglio::surface {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Outside the cones of features already found, up to which level slabs are asked; for the nearest point level
// 0 is enough (measured).
constexpr int slab_levels = 4;

// x brought to 0..period, by so many whole periods.
double within_period(double x, double period, double& periods) {
  periods = std::floor(x / period);
  return std::clamp(x - periods * period, 0.0, period);
}

// Cells in so many sides; 0 where an int cannot count them.
int whole_cells(double sides, int cells) {
  const double count = sides * cells;
  return std::abs(count) < 1e9 ? static_cast<int>(count) : 0;
}

// How far a coordinate is from one of the copies of a period.
double copy_away(int copy, double period, double at) {
  return away(copy * period - at, (copy + 1) * period - at);
}

}  // namespace

bool Cones::hold(const Vec3& direction) const {
  return std::any_of(found_.begin(), found_.end(),
                     [&](const Feature& f) { return f.direction.dot(direction) > cos_; });
}

bool Cones::hold_ball(const Vec3& centre, double radius) const {
  const double distance2 = centre.squaredNorm();
  // The ball looks asin(radius / distance) wide, and its centre must be that much inside the cone; min_angle
  // < 90 degrees.
  if (cos_ <= 0 || radius * radius >= sin_ * sin_ * distance2) return false;
  // distance * cos(min_angle - asin(radius / distance))
  const double needed = cos_ * std::sqrt(distance2 - radius * radius) + sin_ * radius;
  return std::any_of(found_.begin(), found_.end(),
                     [&](const Feature& f) { return -sign_ * f.direction.dot(centre) > needed; });
}

bool Cones::hold_near(const Vec3& middle, double w, double h, double z_s, double z_t, double play,
                      double reach) const {
  if (cos_ <= 0) return false;
  return std::any_of(found_.begin(), found_.end(), [&](const Feature& f) {
    const Vec3 axis = -sign_ * f.direction;
    const double off = 0.5 * std::abs(axis.x() * w + axis.z() * z_s) +
                       0.5 * std::abs(axis.y() * h + axis.z() * z_t) + play * std::abs(axis.z());
    return axis.dot(middle) - off > cos_ * reach;
  });
}

ClosestSearch::ClosestSearch(const Surface& surface, const Vec3& p, double sign, double limit,
                             const Cones& cones)
    : surface_(surface),
      pyramid_(surface.pyramid()),
      w_(surface.texel_u()),
      h_(surface.texel_v()),
      p_(p),
      asking_(p),
      sign_(sign),
      cones_(cones),
      best2_(limit * limit),
      best_distance_(limit) {
  if (surface.edge() == Edge::wrap) {
    // A million sides away the answer is the same as here, and numbers are better here.
    asking_.x() = within_period(p.x(), surface.placement().size_u(), sides_x_);
    asking_.y() = within_period(p.y(), surface.placement().size_v(), sides_y_);
  }
  std::tie(under_i_, under_j_) = surface.cell_at(asking_.x(), asking_.y());
}

std::optional<Feature> ClosestSearch::run() {
  const Grid& grid = surface_.grid();
  const Cell cell = surface_.cell(under_i_, under_j_);
  consider(SeenPatch(cell, asking_), under_i_, under_j_);
  if (surface_.edge() == Edge::clamp) {
    search_copy(0, 0);
  } else {
    // The copy of the texture that p is over, then those around it.
    const int i = under_i_ < 0 ? -1 : 0, j = under_j_ < 0 ? -1 : 0;
    constexpr std::array<int, 3> order = {0, -1, 1};
    for (const int b : order) {
      if (copy_away(j + b, h_ * grid.height, asking_.y() - 0.5 * h_) >= best_distance_) continue;
      for (const int a : order) {
        if (copy_away(i + a, w_ * grid.width, asking_.x() - 0.5 * w_) < best_distance_)
          search_copy((i + a) * grid.width, (j + b) * grid.height);
      }
    }
  }
  return best_ ? std::optional(feature()) : std::nullopt;
}

// The blocks of the lowest level at which they are two by two at most within `wide` of p in plan.
ClosestSearch::Blocks ClosestSearch::blocks_within(double wide) const {
  int level = 1;
  while (level < pyramid_.levels() && Pyramid::side(level) * std::min(w_, h_) < 2 * wide) ++level;
  if (level == pyramid_.levels()) return {level, 0, 0, 0, 0};
  const auto block = [&](double from_origin, double size, int cells) {
    const int last = (cells - 1) / Pyramid::side(level);
    return static_cast<int>(
        std::clamp(std::floor(from_origin / (size * Pyramid::side(level))), 0.0, double(last)));
  };
  return {level, block(-wide - origin_x_, w_, pyramid_.columns()),
          block(wide - origin_x_, w_, pyramid_.columns()), block(-wide - origin_y_, h_, pyramid_.rows()),
          block(wide - origin_y_, h_, pyramid_.rows())};
}

// How far the relief in these blocks is above or below p, at least.
double ClosestSearch::height_away(const Blocks& blocks) const {
  Pyramid::Range all = pyramid_.whole();
  if (blocks.level < pyramid_.levels()) {
    all = pyramid_.range(blocks.level, blocks.x0, blocks.y0);
    for (int y = blocks.y0; y <= blocks.y1; ++y) {
      for (int x = blocks.x0; x <= blocks.x1; ++x) {
        const Pyramid::Range range = pyramid_.range(blocks.level, x, y);
        all = {std::min(all.shallow, range.shallow), std::max(all.deep, range.deep)};
      }
    }
  }
  return away(-surface_.max_depth() * all.deep - asking_.z(),
              -surface_.max_depth() * all.shallow - asking_.z());
}

// Of one copy of the texture, the blocks within reach; seen from far above, that is little in plan.
void ClosestSearch::search_copy(int shift_i, int shift_j) {
  shift_i_ = shift_i;
  shift_j_ = shift_j;
  origin_x_ = (shift_i + pyramid_.first() + 0.5) * w_ - asking_.x();
  origin_y_ = (shift_j + pyramid_.first() + 0.5) * h_ - asking_.y();
  Blocks blocks = blocks_within(best_distance_);
  const double dz = height_away(blocks);
  if (dz >= best_distance_) return;
  if (dz > 0.5 * best_distance_) blocks = blocks_within(std::sqrt(best2_ - dz * dz));
  if (blocks.level == pyramid_.levels()) return descend({0, blocks.level - 1, 0, 0});
  for (int y = blocks.y0; y <= blocks.y1; ++y) {
    for (int x = blocks.x0; x <= blocks.x1; ++x) {
      if (cones_.empty() || blocks.level > slab_levels || !is_useless(blocks.level, x, y))
        descend({0, blocks.level - 1, x, y});
    }
  }
}

void ClosestSearch::descend(const Entry& top) {
  std::array<Entry, deepest> stack;
  std::size_t count = 0;
  stack[count++] = top;
  std::array<Entry, 4> children;
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.bound2 >= best2_) continue;
    const std::size_t near = near_children(entry, children);
    // Nearest first: a leaf at once, a block last onto the stack.
    if (entry.level == 0) {
      for (std::size_t k = 0; k < near; ++k) prefetch(children[k].x, children[k].y);
      for (std::size_t k = 0; k < near; ++k) {
        if (children[k].bound2 < best2_ && !is_useless(0, children[k].x, children[k].y))
          visit_leaf(children[k].x, children[k].y);
      }
    } else {
      for (std::size_t k = 0; k < near; ++k)
        pyramid_.prefetch_quad(entry.level - 1, children[k].x, children[k].y);
      const bool ask_slab = !cones_.empty() && entry.level <= slab_levels;
      for (std::size_t k = near; k-- > 0;) {
        if (!(ask_slab && is_useless(entry.level, children[k].x, children[k].y)))
          stack[count++] = children[k];
      }
    }
  }
}

// Asks the cache for the texels of a block.
void ClosestSearch::prefetch(int x, int y) const {
  const TexelTiles& tiles = surface_.tiles();
  const int i = pyramid_.first() + x * leaf, j = pyramid_.first() + y * leaf;
  const std::size_t left = tiles.column(i), right = tiles.column(i + leaf);
  for (const std::size_t row : {tiles.row(j), tiles.row(j + leaf)}) {
    tiles.prefetch_depth(row + left);
    tiles.prefetch_depth(row + right);
  }
}

// The children of a block whose boxes are nearer than the best so far, nearest first. Returns how many.
std::size_t ClosestSearch::near_children(const Entry& entry, std::array<Entry, 4>& children) const {
  const int side = Pyramid::side(entry.level);
  const double width = side * w_, height = side * h_;
  std::array<double, 3> x, y;
  x[0] = origin_x_ + 2 * entry.x * width;
  y[0] = origin_y_ + 2 * entry.y * height;
  x[1] = x[0] + width;
  y[1] = y[0] + height;
  x[2] = x[1] + width;
  y[2] = y[1] + height;
  if (surface_.edge() == Edge::clamp) {
    // The outermost blocks go on for ever.
    if (entry.x == 0) x[0] = -infinity;
    if (entry.y == 0) y[0] = -infinity;
    for (int k = 1; k < 3; ++k) {
      if ((2 * entry.x + k) * side >= pyramid_.columns()) x[std::size_t(k)] = infinity;
      if ((2 * entry.y + k) * side >= pyramid_.rows()) y[std::size_t(k)] = infinity;
    }
  }
  const double dx0 = away(x[0], x[1]), dx1 = away(x[1], x[2]), dy0 = away(y[0], y[1]), dy1 = away(y[1], y[2]);
  using Four = Eigen::Array<double, 4, 1>;
  const Pyramid::Bounds4 quad = pyramid_.quad(entry.level, entry.x, entry.y);
  const Four low = -surface_.max_depth() * Eigen::Map<const Four>(quad.deep.data()) - asking_.z();
  const Four high = -surface_.max_depth() * Eigen::Map<const Four>(quad.shallow.data()) - asking_.z();
  const Four dz = low.max(-high).max(0.0);
  const Four bound2 =
      Four(dx0 * dx0 + dy0 * dy0, dx1 * dx1 + dy0 * dy0, dx0 * dx0 + dy1 * dy1, dx1 * dx1 + dy1 * dy1) +
      dz * dz;
  std::size_t count = 0;
  for (int k = 0; k < 4; ++k) {
    if (bound2[k] >= best2_) continue;
    std::size_t at = count++;
    for (; at > 0 && children[at - 1].bound2 > bound2[k]; --at) children[at] = children[at - 1];
    children[at] = {bound2[k], entry.level - 1, 2 * entry.x + (k & 1), 2 * entry.y + (k >> 1)};
  }
  return count;
}

bool ClosestSearch::in_cone(const Vec3& middle, double w, double h, double z_s, double z_t,
                            double play) const {
  const double across = w * w + h * h;
  const double diagonal2 = across + std::max((z_s + z_t) * (z_s + z_t), (z_s - z_t) * (z_s - z_t));
  return cones_.hold_ball(middle, 0.5 * std::sqrt(diagonal2) + play);
}

bool ClosestSearch::near_in_cone(const Vec3& middle, double w, double h, double z_s, double z_t,
                                 double play) const {
  // Only what is within reach counts, so the sides may be cut to that.
  const double thick = 0.5 * (std::abs(z_s) + std::abs(z_t)) + play;
  const double dz = away(middle.z() - thick, middle.z() + thick), wide2 = best2_ - dz * dz;
  if (!(wide2 > 0)) return true;
  const double wide = std::sqrt(wide2);
  const double x0 = std::max(middle.x() - 0.5 * w, -wide), x1 = std::min(middle.x() + 0.5 * w, wide),
               y0 = std::max(middle.y() - 0.5 * h, -wide), y1 = std::min(middle.y() + 0.5 * h, wide);
  if (!(x0 < x1 && y0 < y1)) return true;
  const double x = 0.5 * (x0 + x1), y = 0.5 * (y0 + y1), slope_x = z_s / w, slope_y = z_t / h;
  const double z = middle.z() + slope_x * (x - middle.x()) + slope_y * (y - middle.y());
  return cones_.hold_near({x, y, z}, x1 - x0, y1 - y0, slope_x * (x1 - x0), slope_y * (y1 - y0), play,
                          best_distance_);
}

// Whether the slab of a block shows that nothing in it is wanted.
bool ClosestSearch::is_useless(int level, int x, int y) const {
  const int side = Pyramid::side(level);
  if (surface_.edge() == Edge::clamp &&
      (x == 0 || y == 0 || (x + 1) * side >= pyramid_.columns() || (y + 1) * side >= pyramid_.rows())) {
    return false;  // it stands for everything beyond the border
  }
  const Pyramid::Slab slab = pyramid_.slab(level, x, y);
  const double scale = -surface_.max_depth(), w = side * w_, h = side * h_;
  const double a = scale * side * slab.slope_x, b = scale * side * slab.slope_y;
  const double play = -scale * 0.5 * (slab.high - slab.low);
  const Vec3 middle(origin_x_ + (x + 0.5) * w, origin_y_ + (y + 0.5) * h,
                    scale * 0.5 * (slab.low + slab.high) - asking_.z());
  if (parallelogram_beyond(middle, w, h, a, b, best_distance_ + play)) return true;
  if (cones_.empty()) return false;
  if (near_in_cone(middle, w, h, a, b, play) || in_cone(middle, w, h, a, b, play)) return true;
  if (level > 0) {
    // The slab of a large block may tilt; its box does not.
    const Pyramid::Range range = pyramid_.range(level, x, y);
    const Vec3 centre(middle.x(), middle.y(), scale * 0.5 * (range.shallow + range.deep) - asking_.z());
    if (near_in_cone(centre, w, h, 0, 0, -scale * 0.5 * (range.deep - range.shallow))) return true;
  }
  // Where the distance falls all along an axis there is no minimum, except on the border. So the cells around
  // the block count too: a quarter more on both sides, at most.
  const double spread_a = -scale * side * slab.spread_x, spread_b = -scale * side * slab.spread_y;
  const double rise = play + 0.75 * (std::abs(a) + std::abs(b)) + 0.25 * (spread_a + spread_b);
  const auto falls = [&](double at, double size, double slope, double spread) {
    const double fall = at * size + middle.z() * slope;
    return std::abs(fall) >
           0.75 * size * size + std::abs(middle.z()) * spread + rise * (std::abs(slope) + spread);
  };
  return falls(middle.x(), w, a, spread_a) || falls(middle.y(), h, b, spread_b);
}

Feature ClosestSearch::feature() const {
  return {p_ + best_->patch.at(best_->at.s, best_->at.t), direction_of(*best_), sign_ * best_distance_,
          best_->i + whole_cells(sides_x_, surface_.width()),
          best_->j + whole_cells(sides_y_, surface_.height())};
}

}  // namespace intaglio::surface
