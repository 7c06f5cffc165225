#include "surface/closest_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace intaglio::surface {

namespace {

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

ClosestSearch::ClosestSearch(const Surface& surface, const Vec3& p, double sign, double reach,
                             double min_angle, bool goes_on)
    : surface_(surface),
      pyramid_(surface.pyramid()),
      w_(surface.texel_u()),
      h_(surface.texel_v()),
      p_(p),
      asking_(p),
      sign_(sign),
      min_angle_(min_angle),
      reach_(reach),
      goes_on_(goes_on),
      cones_({}, sign, min_angle) {
  if (surface.edge() == Edge::wrap) {
    // A million sides away the answer is the same as here, and numbers are better here.
    asking_.x() = within_period(p.x(), surface.placement().size_u(), sides_x_);
    asking_.y() = within_period(p.y(), surface.placement().size_v(), sides_y_);
  }
  // Floats must tell a hundredth of a texel at that distance.
  const Placement& place = surface.placement();
  const double aside = std::max(away(-asking_.x(), asking_.x() - place.size_u()),
                                away(-asking_.y(), asking_.y() - place.size_v()));
  is_far_ = (std::abs(asking_.z()) + surface.max_depth() + aside) * loss<float> > 0.04 * std::min(w_, h_);
  std::tie(under_i_, under_j_) = surface.cell_at(asking_.x(), asking_.y());
}

std::optional<Feature> ClosestSearch::next(std::span<const Feature> found) {
  cones_ = Cones(found, sign_, min_angle_);
  best_.reset();
  best_distance_ = reach_;
  best2_ = reach_ * reach_;
  if (lost_) {
    lost_ = !goes_on_;
    later_count_ = 0;
    start();
  } else {
    const Later entries = later_;
    const std::size_t count = std::exchange(later_count_, 0);
    for (std::size_t k = 0; k < count; ++k) {
      enter_copy(entries[k].copy_x, entries[k].copy_y);
      descend(entries[k]);
    }
  }
  return best_ ? std::optional(feature()) : std::nullopt;
}

// From the top.
void ClosestSearch::start() {
  const Grid& grid = surface_.grid();
  consider(SeenPatch(surface_.cell(under_i_, under_j_), asking_), under_i_, under_j_);
  if (surface_.edge() == Edge::clamp) return search_copy(0, 0);
  // The copy of the texture that p is over, then those around it.
  const int i = under_i_ < 0 ? -1 : 0, j = under_j_ < 0 ? -1 : 0;
  constexpr std::array<int, 3> order = {0, -1, 1};
  for (const int b : order) {
    if (copy_away(j + b, h_ * grid.height, asking_.y() - 0.5 * h_) >= wanted()) continue;
    for (const int a : order) {
      if (copy_away(i + a, w_ * grid.width, asking_.x() - 0.5 * w_) < wanted()) search_copy(i + a, j + b);
    }
  }
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

void ClosestSearch::enter_copy(int copy_x, int copy_y) {
  copy_x_ = copy_x;
  copy_y_ = copy_y;
  origin_x_ = (copy_x * surface_.width() + pyramid_.first() + 0.5) * w_ - asking_.x();
  origin_y_ = (copy_y * surface_.height() + pyramid_.first() + 0.5) * h_ - asking_.y();
}

// Of one copy of the texture, the blocks within reach; seen from far above, that is little in plan.
void ClosestSearch::search_copy(int copy_x, int copy_y) {
  enter_copy(copy_x, copy_y);
  const double wide = wanted();
  Blocks blocks = blocks_within(wide);
  const double dz = height_away(blocks);
  if (dz >= wide) return;
  if (dz > 0.5 * wide) blocks = blocks_within(std::sqrt(wide * wide - dz * dz));
  const auto descend_from = [&](int x, int y) {
    descend({0, blocks.level - 1, x, y, std::int8_t(copy_x), std::int8_t(copy_y), 0xf});
  };
  if (blocks.level == pyramid_.levels()) return descend_from(0, 0);
  for (int y = blocks.y0; y <= blocks.y1; ++y) {
    for (int x = blocks.x0; x <= blocks.x1; ++x) descend_from(x, y);
  }
}

void ClosestSearch::descend(const Entry& top) {
  std::array<Entry, deepest> stack;
  std::size_t count = 0;
  stack[count++] = top;
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.bound2 >= best2_) {
      keep(entry, entry.blocks);
      continue;
    }
    const Seen seen = look_at(entry);
    // Nearest first: a leaf at once, a block last onto the stack.
    std::array<std::uint8_t, 4> order;
    std::size_t near = 0;
    for (unsigned k = 0; k < 4; ++k) {
      if ((seen.open >> k & 1u) == 0 || seen.bound2[k] >= best2_) continue;
      std::size_t at = near++;
      for (; at > 0 && seen.bound2[order[at - 1]] > seen.bound2[k]; --at) order[at] = order[at - 1];
      order[at] = std::uint8_t(k);
    }
    unsigned later = seen.open;
    const auto x_of = [&](unsigned k) { return 2 * entry.x + int(k & 1); };
    const auto y_of = [&](unsigned k) { return 2 * entry.y + int(k >> 1); };
    if (entry.level == 0) {
      for (std::size_t n = 0; n < near; ++n) prefetch(x_of(order[n]), y_of(order[n]));
      for (std::size_t n = 0; n < near; ++n) {
        const unsigned k = order[n];
        if (seen.bound2[k] < best2_ && !visit_leaf(x_of(k), y_of(k))) later &= ~(1u << k);
      }
    } else {
      for (std::size_t n = near; n-- > 0;) {
        const unsigned k = order[n];
        later &= ~(1u << k);
        pyramid_.prefetch_quad(entry.level - 1, x_of(k), y_of(k));
        stack[count++] = {seen.bound2[k], entry.level - 1, x_of(k), y_of(k), entry.copy_x, entry.copy_y, 0xf};
      }
    }
    keep(entry, later);
  }
}

// Blocks that may hold a later feature.
void ClosestSearch::keep(Entry entry, unsigned blocks) {
  if (blocks == 0 || !goes_on_ || lost_) return;
  if (later_count_ == later_.size()) {
    lost_ = true;
    return;
  }
  entry.bound2 = 0;
  entry.blocks = static_cast<std::uint8_t>(blocks);
  later_[later_count_++] = entry;
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

Feature ClosestSearch::feature() const {
  return {p_ + best_->patch.at(best_->at.s, best_->at.t), direction_of(*best_), sign_ * best_distance_,
          best_->i + whole_cells(sides_x_, surface_.width()),
          best_->j + whole_cells(sides_y_, surface_.height())};
}

// The part of ClosestSearch that looks at the four blocks of a quad.

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

// The part of ClosestSearch that looks at single cells.

// Where the cells of block (x, y) are, and their texels.
void ClosestSearch::load(int x, int y, Leaf& out) const {
  out.i = pyramid_.first() + x * leaf;
  out.j = pyramid_.first() + y * leaf;
  out.columns = std::min(leaf, pyramid_.columns() - x * leaf);
  out.rows = std::min(leaf, pyramid_.rows() - y * leaf);
  // Under clamp the outermost cells are not where they are stored.
  out.inner =
      surface_.edge() == Edge::wrap || (out.i >= 1 && out.j >= 1 && out.i + leaf + 1 < surface_.width() &&
                                        out.j + leaf + 1 < surface_.height());
  const TexelTiles& tiles = surface_.tiles();
  std::array<std::size_t, leaf + 1> column;
  for (int c = 0; c <= leaf; ++c) column[std::size_t(c)] = tiles.column(out.i + c);
  for (int r = 0; r <= leaf; ++r) {
    const std::size_t row = tiles.row(out.j + r);
    for (std::size_t c = 0; c <= leaf; ++c) out.depth[std::size_t(r)][c] = tiles.depth(row + column[c]);
  }
  // To the bit as in Surface::cell, so that the same cell is as far whoever asks.
  const int i = copy_x_ * surface_.width() + out.i, j = copy_y_ * surface_.height() + out.j;
  for (int c = 0; c < leaf; ++c) {
    out.left[std::size_t(c)] = start_of((i + c + 0.5) * w_ - asking_.x(), w_, out.i + c, surface_.width());
    out.low[std::size_t(c)] = start_of((j + c + 0.5) * h_ - asking_.y(), h_, out.j + c, surface_.height());
  }
}

// Bounds of the cells' distances; the answer has a bit for each that may hold something wanted.
template <class T>
unsigned ClosestSearch::look_at(Leaf& block) const {
  using Row = Eigen::Array<float, 4, 1>;
  const T depth = static_cast<T>(surface_.max_depth()), z = static_cast<T>(asking_.z()),
          w = static_cast<T>(w_), h = static_cast<T>(h_);
  const T limit = static_cast<T>(wanted()) * (1 + loss<T>);
  const Four<T> left = Eigen::Map<const Four<double>>(block.left.data()).template cast<T>();
  unsigned open = 0;
  for (int r = 0; r < block.rows; ++r) {
    const float *one = block.depth[std::size_t(r)].data(), *other = block.depth[std::size_t(r + 1)].data();
    const Four<T> z0 = -depth * Eigen::Map<const Row>(one).template cast<T>() - z,
                  z1 = -depth * Eigen::Map<const Row>(one + 1).template cast<T>() - z,
                  z2 = -depth * Eigen::Map<const Row>(other).template cast<T>() - z,
                  z3 = -depth * Eigen::Map<const Row>(other + 1).template cast<T>() - z;
    const T low = static_cast<T>(block.low[std::size_t(r)]);
    const Boxes<T> boxes{left,
                         left + w,
                         Four<T>::Constant(low),
                         Four<T>::Constant(low + h),
                         z0.min(z1).min(z2.min(z3)) - height_loss<T>(),
                         z0.max(z1).max(z2.max(z3)) + height_loss<T>()};
    const TiltedPieces<T> planes{left + T(0.5) * w,
                                 Four<T>::Constant(low + T(0.5) * h),
                                 T(0.25) * ((z0 + z1) + (z2 + z3)),
                                 (T(0.5) / w) * ((z1 - z0) + (z3 - z2)),
                                 (T(0.5) / h) * ((z2 - z0) + (z3 - z1)),
                                 T(0.25) * ((z3 - z2) - (z1 - z0)).abs() + height_loss<T>(),
                                 w,
                                 h};
    const Four<T> bound2 = boxes.least_distance2().max(planes.least_distance2());
    unsigned row = less<T>(bound2, Four<T>::Constant(limit * limit));
    if (!cones_.empty() && row != 0) {
      const Reached<T> reached(boxes, limit);
      for (std::size_t k = 0; k < cones_.size(); ++k)
        row &= ~reached.planes_in_cone(planes, cones_.axis(k), cones_.cosine());
    }
    for (std::size_t c = 0; c < leaf; ++c)
      block.bound2[std::size_t(r) * leaf + c] = double(bound2[Eigen::Index(c)]);
    open |= (row & ((1u << block.columns) - 1)) << (r * leaf);
  }
  return open;
}

SeenPatch ClosestSearch::patch_of(const Leaf& block, std::size_t k) const {
  const std::size_t c = k % leaf, r = k / leaf;
  const auto z = [&](std::size_t row, std::size_t column) {
    return -surface_.max_depth() * double(block.depth[row][column]) - asking_.z();
  };
  return {block.left[c], block.low[r], w_, h_, z(r, c), z(r, c + 1), z(r + 1, c), z(r + 1, c + 1)};
}

// Looks at the cells of a block, nearest first. Whether any may still hold a later feature.
bool ClosestSearch::visit_leaf(int x, int y) {
  Leaf block;
  load(x, y, block);
  unsigned open = is_far_ ? look_at<double>(block) : look_at<float>(block), later = open;
  while (open != 0) {
    unsigned k = unsigned(std::countr_zero(open));
    for (unsigned rest = open & (open - 1); rest != 0; rest &= rest - 1) {
      const unsigned other = unsigned(std::countr_zero(rest));
      if (block.bound2[other] < block.bound2[k]) k = other;
    }
    if (block.bound2[k] >= best2_) break;
    open &= ~(1u << k);
    const int i = index_of(block.i + int(k % leaf), surface_.width(), under_i_) + copy_x_ * surface_.width(),
              j = index_of(block.j + int(k / leaf), surface_.height(), under_j_) +
                  copy_y_ * surface_.height();
    const SeenPatch patch = patch_of(block, k);
    // Beyond a border one cell stands in several places.
    if (best_ && best_->i == i && best_->j == j && best_->patch.x == patch.x && best_->patch.y == patch.y)
      continue;
    if ((!cones_.empty() && block.inner && has_no_minimum(block, k)) ||
        consider(patch, i, j) == Verdict::useless)
      later &= ~(1u << k);
  }
  return later != 0;
}

// Whether the slope of half the squared distance cannot be zero in a cell, nor in the cells around it.
bool ClosestSearch::has_no_minimum(const Leaf& block, std::size_t k) const {
  const int column = int(k % leaf), row = int(k / leaf);
  const TexelTiles& tiles = surface_.tiles();
  std::array<std::size_t, 4> at;
  for (int c = 0; c < 4; ++c) at[std::size_t(c)] = tiles.column(block.i + column + c - 1);
  double z_low = infinity, z_high = -infinity, x_low = infinity, x_high = -infinity, y_low = infinity,
         y_high = -infinity;
  std::array<double, 4> below{};
  for (int r = 0; r < 4; ++r) {
    const std::size_t from = tiles.row(block.j + row + r - 1);
    double before = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const double z = -surface_.max_depth() * double(tiles.depth(from + at[c])) - asking_.z();
      z_low = std::min(z_low, z);
      z_high = std::max(z_high, z);
      if (c > 0) {
        x_low = std::min(x_low, z - before);
        x_high = std::max(x_high, z - before);
      }
      if (r > 0) {
        y_low = std::min(y_low, z - below[c]);
        y_high = std::max(y_high, z - below[c]);
      }
      before = below[c] = z;
    }
  }
  const auto falls = [&](double start, double size, double rise_low, double rise_high) {
    const double least = std::min(std::min(z_low * rise_low, z_low * rise_high),
                                  std::min(z_high * rise_low, z_high * rise_high));
    const double most = std::max(std::max(z_low * rise_low, z_low * rise_high),
                                 std::max(z_high * rise_low, z_high * rise_high));
    return (start - size) * size + least > 0 || (start + 2 * size) * size + most < 0;
  };
  return falls(block.left[std::size_t(column)], w_, x_low, x_high) ||
         falls(block.low[std::size_t(row)], h_, y_low, y_high);
}

ClosestSearch::Verdict ClosestSearch::consider(const SeenPatch& patch, int i, int j) {
  const NearestOnPatch at = nearest(patch);
  if (!(at.distance2 < best2_)) return Verdict::farther;
  const Best candidate{patch, at, i, j};
  // The nearest of all is a minimum and turns its outer side; others must show it.
  if (!cones_.empty()) {
    const Vec3 direction = direction_of(candidate);
    if (cones_.hold(direction) || direction.dot(normal_of(candidate)) <= 0 || !is_local_minimum(candidate))
      return Verdict::useless;
  }
  best2_ = at.distance2;
  best_distance_ = std::sqrt(best2_);
  best_ = candidate;
  return Verdict::best;
}

Vec3 ClosestSearch::normal_of(const Best& b) const {
  return Vec3(-b.patch.z_s(b.at.t) / w_, -b.patch.z_t(b.at.s) / h_, 1).normalized();
}

Vec3 ClosestSearch::direction_of(const Best& b) const {
  const double length = std::sqrt(b.at.distance2);
  return length > 1e-12 ? Vec3(-sign_ / length * b.patch.at(b.at.s, b.at.t)) : normal_of(b);
}

// Whether the distance also grows out of the cell, where its nearest point is on the border. Along the border
// and inwards it grows, or the point would not be the cell's nearest.
bool ClosestSearch::is_local_minimum(const Best& candidate) const {
  const auto& [patch, at, i, j] = candidate;
  const Vec3 there = patch.at(at.s, at.t);
  const auto falls = [&](double along, double step, double rise) {
    return along * step + there.z() * rise < -1e-9 * there.norm() * (std::abs(step) + std::abs(rise));
  };
  if (at.s <= 0 || at.s >= 1) {
    const int out = at.s <= 0 ? -1 : 1;
    const Cell beyond = surface_.cell(i + out, j);
    const double rise =
        beyond.z[1] - beyond.z[0] + at.t * (beyond.z[3] - beyond.z[2] - beyond.z[1] + beyond.z[0]);
    if (falls(there.x(), out * w_, out * rise)) return false;
  }
  if (at.t <= 0 || at.t >= 1) {
    const int out = at.t <= 0 ? -1 : 1;
    const Cell beyond = surface_.cell(i, j + out);
    const double rise =
        beyond.z[2] - beyond.z[0] + at.s * (beyond.z[3] - beyond.z[2] - beyond.z[1] + beyond.z[0]);
    if (falls(there.y(), out * h_, out * rise)) return false;
  }
  return true;
}

}  // namespace intaglio::surface
