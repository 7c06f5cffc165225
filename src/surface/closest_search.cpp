#include "surface/closest_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace intaglio::surface {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// The highest level whose slabs are tested once there are cones; for the first feature level 0 suffices
// (measured).
constexpr int slab_levels = 4;

template <class T>
std::array<double, 4> doubles(const Four<T>& four) {
  return {four[0], four[1], four[2], four[3]};
}

// x moved into 0..period; `periods` receives how far, in periods.
double within_period(double x, double period, double& periods) {
  periods = std::floor(x / period);
  return std::clamp(x - periods * period, 0.0, period);
}

// Cells in `sides` tiles; 0 where the number does not fit an int.
int whole_cells(double sides, int cells) {
  const double count = sides * cells;
  return std::abs(count) < 1e9 ? int(count) : 0;
}

// Distance of a coordinate from a tile.
double distance_to_tile(int copy, double period, double at) {
  return distance_to_interval(copy * period - at, (copy + 1) * period - at);
}

}  // namespace

ClosestSearch::ClosestSearch(const Surface& surface, const Vec3& p, double sign, double reach,
                             double min_angle, bool resumable)
    : surface_(surface),
      pyramid_(surface.pyramid()),
      w_(surface.texel_u()),
      h_(surface.texel_v()),
      query_as_given_(p),
      query_(p),
      sign_(sign),
      min_angle_(min_angle),
      reach_(reach),
      resumable_(resumable),
      cones_({}, sign, min_angle) {
  if (surface.edge() == Edge::wrap) {
    // The relief is periodic: move the query into the base tile, for precision.
    query_.x() = within_period(p.x(), surface.placement().size_u(), tiles_x_);
    query_.y() = within_period(p.y(), surface.placement().size_v(), tiles_y_);
  }
  // Double where float cannot resolve a hundredth of a texel at this distance: height_slack() is a quarter of
  // rounding_slack.
  const Placement& place = surface.placement();
  const double aside = std::max(distance_to_interval(-query_.x(), query_.x() - place.size_u()),
                                distance_to_interval(-query_.y(), query_.y() - place.size_v()));
  use_double_ = (std::abs(query_.z()) + surface.max_depth() + aside) * rounding_slack<float> >
                4 * 0.01 * std::min(w_, h_);
  std::tie(cell_i_, cell_j_) = surface.cell_at(query_.x(), query_.y());
}

std::optional<Feature> ClosestSearch::next(std::span<const Feature> found) {
  cones_ = Cones(found, sign_, min_angle_);
  best_.reset();
  best_distance_ = reach_;
  best2_ = reach_ * reach_;
  if (must_restart_) {
    must_restart_ = !resumable_;
    deferred_count_ = 0;
    start();
  } else {
    const Deferred entries = deferred_;
    const std::size_t count = std::exchange(deferred_count_, 0);
    for (std::size_t k = 0; k < count; ++k) {
      enter_tile(entries[k].tile_x, entries[k].tile_y);
      descend(entries[k]);
    }
  }
  return best_ ? std::optional(feature()) : std::nullopt;
}

// From the root.
void ClosestSearch::start() {
  const Grid& grid = surface_.grid();
  consider(LocalPatch(surface_.cell(cell_i_, cell_j_), query_), cell_i_, cell_j_);
  if (surface_.edge() == Edge::clamp) return search_tile(0, 0);
  // The tile below the query point, then those around it.
  const int i = cell_i_ < 0 ? -1 : 0, j = cell_j_ < 0 ? -1 : 0;
  constexpr std::array<int, 3> order = {0, -1, 1};
  for (const int b : order) {
    if (distance_to_tile(j + b, h_ * grid.height, query_.y() - 0.5 * h_) >= search_radius()) continue;
    for (const int a : order) {
      if (distance_to_tile(i + a, w_ * grid.width, query_.x() - 0.5 * w_) < search_radius())
        search_tile(i + a, j + b);
    }
  }
}

// Blocks at the lowest level at which at most 2 x 2 of them overlap the square of this half side around the
// query point; `level` may be levels(), the root.
ClosestSearch::Blocks ClosestSearch::blocks_in_square(double half_side) const {
  int level = 1;
  while (level < pyramid_.levels() && Pyramid::block_cells(level) * std::min(w_, h_) < 2 * half_side) ++level;
  if (level == pyramid_.levels()) return {level, 0, 0, 0, 0};
  const auto block = [&](double from_origin, double size, int cells) {
    const int last = (cells - 1) / Pyramid::block_cells(level);
    return int(std::clamp(std::floor(from_origin / (size * Pyramid::block_cells(level))), 0.0, double(last)));
  };
  return {level, block(-half_side - origin_x_, w_, pyramid_.columns()),
          block(half_side - origin_x_, w_, pyramid_.columns()),
          block(-half_side - origin_y_, h_, pyramid_.rows()),
          block(half_side - origin_y_, h_, pyramid_.rows())};
}

// Lower bound on the height difference between the query point and the relief in these blocks.
double ClosestSearch::min_height_distance(const Blocks& blocks) const {
  Pyramid::Range all = pyramid_.total_range();
  if (blocks.level < pyramid_.levels()) {
    all = pyramid_.range(blocks.level, blocks.x0, blocks.y0);
    for (int y = blocks.y0; y <= blocks.y1; ++y) {
      for (int x = blocks.x0; x <= blocks.x1; ++x) {
        const Pyramid::Range range = pyramid_.range(blocks.level, x, y);
        all = {std::min(all.shallow, range.shallow), std::max(all.deep, range.deep)};
      }
    }
  }
  return distance_to_interval(-surface_.max_depth() * all.deep - query_.z(),
                              -surface_.max_depth() * all.shallow - query_.z());
}

void ClosestSearch::enter_tile(int tile_x, int tile_y) {
  tile_x_ = tile_x;
  tile_y_ = tile_y;
  origin_x_ = (tile_x * surface_.width() + pyramid_.first_cell() + 0.5) * w_ - query_.x();
  origin_y_ = (tile_y * surface_.height() + pyramid_.first_cell() + 0.5) * h_ - query_.y();
}

// Searches one tile. Far above the relief, only a small disc in plan can be within reach, so the descent
// starts at a low level.
void ClosestSearch::search_tile(int tile_x, int tile_y) {
  enter_tile(tile_x, tile_y);
  const double half_side = search_radius();
  Blocks blocks = blocks_in_square(half_side);
  const double dz = min_height_distance(blocks);
  if (dz >= half_side) return;
  if (dz > 0.5 * half_side) blocks = blocks_in_square(std::sqrt(half_side * half_side - dz * dz));
  const auto descend_from = [&](int x, int y) {
    descend({0, blocks.level - 1, x, y, std::int8_t(tile_x), std::int8_t(tile_y), 0xf});
  };
  if (blocks.level == pyramid_.levels()) return descend_from(0, 0);
  for (int y = blocks.y0; y <= blocks.y1; ++y) {
    for (int x = blocks.x0; x <= blocks.x1; ++x) descend_from(x, y);
  }
}

void ClosestSearch::descend(const Entry& top) {
  std::array<Entry, max_stack> stack;
  std::size_t count = 0;
  stack[count++] = top;
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.bound2 >= best2_) {
      defer(entry, entry.blocks);
      continue;
    }
    const BlockBounds bounds = bound_blocks(entry);
    // Nearest first: leaves are visited in order; of other blocks the nearest is pushed last.
    std::array<std::uint8_t, 4> order;
    std::size_t near = 0;
    for (unsigned k = 0; k < 4; ++k) {
      if ((bounds.candidates >> k & 1u) == 0 || bounds.bound2[k] >= best2_) continue;
      std::size_t at = near++;
      for (; at > 0 && bounds.bound2[order[at - 1]] > bounds.bound2[k]; --at) order[at] = order[at - 1];
      order[at] = std::uint8_t(k);
    }
    unsigned later = bounds.candidates;
    const auto x_of = [&](unsigned k) { return 2 * entry.x + int(k & 1); };
    const auto y_of = [&](unsigned k) { return 2 * entry.y + int(k >> 1); };
    if (entry.level == 0) {
      for (std::size_t n = 0; n < near; ++n) prefetch(x_of(order[n]), y_of(order[n]));
      for (std::size_t n = 0; n < near; ++n) {
        const unsigned k = order[n];
        if (bounds.bound2[k] < best2_ && !visit_leaf(x_of(k), y_of(k))) later &= ~(1u << k);
      }
    } else {
      for (std::size_t n = near; n-- > 0;) {
        const unsigned k = order[n];
        later &= ~(1u << k);
        pyramid_.prefetch_quad(entry.level - 1, x_of(k), y_of(k));
        stack[count++] = {bounds.bound2[k], entry.level - 1, x_of(k), y_of(k),
                          entry.tile_x,     entry.tile_y,    0xf};
      }
    }
    defer(entry, later);
  }
}

// Keeps blocks that may contain a later feature.
void ClosestSearch::defer(Entry entry, unsigned blocks) {
  if (blocks == 0 || !resumable_ || must_restart_) return;
  if (deferred_count_ == deferred_.size()) {
    must_restart_ = true;
    return;
  }
  entry.bound2 = 0;
  entry.blocks = std::uint8_t(blocks);
  deferred_[deferred_count_++] = entry;
}

// Prefetches a block's texels.
void ClosestSearch::prefetch(int x, int y) const {
  const TexelTiles& tiles = surface_.tiles();
  const int i = pyramid_.first_cell() + x * leaf, j = pyramid_.first_cell() + y * leaf;
  const std::size_t left = tiles.column(i), right = tiles.column(i + leaf);
  for (const std::size_t row : {tiles.row(j), tiles.row(j + leaf)}) {
    tiles.prefetch_depth(row + left);
    tiles.prefetch_depth(row + right);
  }
}

Feature ClosestSearch::feature() const {
  return {query_as_given_ + best_->patch.at(best_->at.s, best_->at.t), direction_of(*best_),
          sign_ * best_distance_, best_->i + whole_cells(tiles_x_, surface_.width()),
          best_->j + whole_cells(tiles_y_, surface_.height())};
}

// --- The four blocks of a quad ---

// The rectangles of a quad's blocks in plan, and whether some extend beyond the border.
template <class T>
void ClosestSearch::block_rectangles(const Entry& entry, Boxes<T>& boxes, bool& at_border) const {
  const int side = Pyramid::block_cells(entry.level);
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
    // The outermost blocks extend to infinity.
    if (entry.x == 0) x[0] = -infinity;
    if (entry.y == 0) y[0] = -infinity;
    for (int k = 1; k < 3; ++k) {
      if ((2 * entry.x + k) * side >= pyramid_.columns()) x[std::size_t(k)] = infinity;
      if ((2 * entry.y + k) * side >= pyramid_.rows()) y[std::size_t(k)] = infinity;
    }
    at_border = std::isinf(x[0]) || std::isinf(y[0]) || std::isinf(x[2]) || std::isinf(y[2]);
  }
  const auto t = [](double value) { return T(value); };
  boxes.x0 = Four<T>(t(x[0]), t(x[1]), t(x[0]), t(x[1]));
  boxes.x1 = Four<T>(t(x[1]), t(x[2]), t(x[1]), t(x[2]));
  boxes.y0 = Four<T>(t(y[0]), t(y[0]), t(y[1]), t(y[1]));
  boxes.y1 = Four<T>(t(y[1]), t(y[1]), t(y[2]), t(y[2]));
}

// The slabs of a quad's blocks.
template <class T>
Slabs<T> ClosestSearch::slabs_of(const Entry& entry, const Boxes<T>& boxes) const {
  const Pyramid::Slabs4& slabs = pyramid_.slabs(entry.level, entry.x, entry.y);
  const T depth = T(surface_.max_depth()), unit = T(Pyramid::depth_unit),
          slope_unit = depth * T(Pyramid::slope_unit);
  const auto w = T(w_), h = T(h_);
  const int side = Pyramid::block_cells(entry.level);
  Four<T> low, high, slope_x, slope_y;
  for (int k = 0; k < 4; ++k) {
    low[k] = slabs.low[std::size_t(k)];
    high[k] = slabs.high[std::size_t(k)];
    slope_x[k] = slabs.slope_x[std::size_t(k)];
    slope_y[k] = slabs.slope_y[std::size_t(k)];
  }
  return {T(0.5) * (boxes.x0 + boxes.x1),
          T(0.5) * (boxes.y0 + boxes.y1),
          -(T(0.5) * depth * unit) * (low + high) - T(query_.z()),
          -(slope_unit / w) * slope_x,
          -(slope_unit / h) * slope_y,
          (T(0.5) * depth * unit) * (high - low) + height_slack<T>(),
          T(side) * w,
          T(side) * h};
}

// Bounds on how much the slopes of the relief differ from those of the slabs.
template <class T>
std::array<Four<T>, 2> ClosestSearch::slope_spreads(const Entry& entry) const {
  const Pyramid::Slabs4& slabs = pyramid_.slabs(entry.level, entry.x, entry.y);
  Four<T> x, y;
  for (int k = 0; k < 4; ++k) {
    x[k] = slabs.spread_x[std::size_t(k)];
    y[k] = slabs.spread_y[std::size_t(k)];
  }
  const double unit = surface_.max_depth() * pyramid_.spread_unit();
  return {T(unit / w_) * x, T(unit / h_) * y};
}

// Mask of the quad's blocks that exist.
unsigned ClosestSearch::existing_blocks(const Entry& entry) const {
  const int side = Pyramid::block_cells(entry.level);
  unsigned out = 0xf;
  if ((2 * entry.x + 1) * side >= pyramid_.columns()) out &= 0x5;
  if ((2 * entry.y + 1) * side >= pyramid_.rows()) out &= 0x3;
  return out;
}

// Bounds each block and returns those that may contain a candidate.
template <class T>
ClosestSearch::BlockBounds ClosestSearch::bound_blocks(const Entry& entry) const {
  Boxes<T> boxes;
  bool at_border;
  block_rectangles(entry, boxes, at_border);
  Slabs<T> planes;
  const bool tilts = entry.level == 0 || (!cones_.empty() && entry.level <= slab_levels && !at_border);
  if (tilts) planes = slabs_of(entry, boxes);
  if (entry.level > 0) {
    const Pyramid::Bounds4 quad = pyramid_.quad(entry.level, entry.x, entry.y);
    const T depth = T(surface_.max_depth()), z = T(query_.z());
    using Floats = Eigen::Map<const Four<float>>;
    boxes.z0 = -depth * Floats(quad.deep.data()).template cast<T>() - (z + height_slack<T>());
    boxes.z1 = -depth * Floats(quad.shallow.data()).template cast<T>() - (z - height_slack<T>());
  } else {
    const Four<T> thick = planes.half_height();
    boxes.z0 = planes.z - thick;
    boxes.z1 = planes.z + thick;
  }
  const T limit = T(search_radius()) * (1 + rounding_slack<T>);
  const Four<T> limit2 = Four<T>::Constant(limit * limit);
  Four<T> bound2 = boxes.min_distance2();
  unsigned candidates = entry.blocks & existing_blocks(entry) & less<T>(bound2, limit2);
  if (tilts && !at_border && candidates != 0) {
    bound2 = bound2.max(planes.min_distance2());
    candidates &= less<T>(bound2, limit2);
  }
  if (!cones_.empty() && candidates != 0) {
    const ClippedBoxes<T> reached(boxes, limit);
    for (std::size_t k = 0; k < cones_.size() && candidates != 0; ++k) {
      const Vec3 axis = cones_.axis(k);
      if (entry.level > 0) candidates &= ~reached.boxes_in_cone(axis, cones_.cosine());
      if (tilts && !at_border) candidates &= ~reached.planes_in_cone(planes, axis, cones_.cosine());
    }
    if (tilts && !at_border && candidates != 0) {
      const auto [x, y] = slope_spreads<T>(entry);
      candidates &= ~planes.monotonic(x, y);
    }
  }
  return {doubles(bound2), candidates};
}

template ClosestSearch::BlockBounds ClosestSearch::bound_blocks<float>(const Entry&) const;
template ClosestSearch::BlockBounds ClosestSearch::bound_blocks<double>(const Entry&) const;

// --- The cells of a leaf ---

// Loads the texels of block (x, y) and locates its cells.
void ClosestSearch::load(int x, int y, Leaf& out) const {
  out.i = pyramid_.first_cell() + x * leaf;
  out.j = pyramid_.first_cell() + y * leaf;
  out.columns = std::min(leaf, pyramid_.columns() - x * leaf);
  out.rows = std::min(leaf, pyramid_.rows() - y * leaf);
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
  // Bit-identical to Surface::cell, so that both give the same distance.
  const int i = tile_x_ * surface_.width() + out.i, j = tile_y_ * surface_.height() + out.j;
  for (int c = 0; c < leaf; ++c) {
    out.left[std::size_t(c)] = cell_start((i + c + 0.5) * w_ - query_.x(), w_, out.i + c, surface_.width());
    out.low[std::size_t(c)] = cell_start((j + c + 0.5) * h_ - query_.y(), h_, out.j + c, surface_.height());
  }
}

// Bounds each cell and returns a mask of those that may contain a candidate.
template <class T>
unsigned ClosestSearch::bound_cells(Leaf& block) const {
  using Row = Eigen::Array<float, 4, 1>;
  const T depth = T(surface_.max_depth()), z = T(query_.z()), w = T(w_), h = T(h_);
  const T limit = T(search_radius()) * (1 + rounding_slack<T>);
  const Four<T> left = Eigen::Map<const Four<double>>(block.left.data()).template cast<T>();
  unsigned candidates = 0;
  for (int r = 0; r < block.rows; ++r) {
    const float *low_row = block.depth[std::size_t(r)].data(),
                *high_row = block.depth[std::size_t(r + 1)].data();
    const Four<T> z0 = -depth * Eigen::Map<const Row>(low_row).template cast<T>() - z,
                  z1 = -depth * Eigen::Map<const Row>(low_row + 1).template cast<T>() - z,
                  z2 = -depth * Eigen::Map<const Row>(high_row).template cast<T>() - z,
                  z3 = -depth * Eigen::Map<const Row>(high_row + 1).template cast<T>() - z;
    const T low = T(block.low[std::size_t(r)]);
    const Boxes<T> boxes{left,
                         left + w,
                         Four<T>::Constant(low),
                         Four<T>::Constant(low + h),
                         z0.min(z1).min(z2.min(z3)) - height_slack<T>(),
                         z0.max(z1).max(z2.max(z3)) + height_slack<T>()};
    const Slabs<T> planes{left + T(0.5) * w,
                          Four<T>::Constant(low + T(0.5) * h),
                          T(0.25) * ((z0 + z1) + (z2 + z3)),
                          (T(0.5) / w) * ((z1 - z0) + (z3 - z2)),
                          (T(0.5) / h) * ((z2 - z0) + (z3 - z1)),
                          T(0.25) * ((z3 - z2) - (z1 - z0)).abs() + height_slack<T>(),
                          w,
                          h};
    const Four<T> bound2 = boxes.min_distance2().max(planes.min_distance2());
    unsigned row = less<T>(bound2, Four<T>::Constant(limit * limit));
    if (!cones_.empty() && row != 0) {
      const ClippedBoxes<T> reached(boxes, limit);
      for (std::size_t k = 0; k < cones_.size(); ++k)
        row &= ~reached.planes_in_cone(planes, cones_.axis(k), cones_.cosine());
    }
    for (std::size_t c = 0; c < leaf; ++c)
      block.bound2[std::size_t(r) * leaf + c] = double(bound2[Eigen::Index(c)]);
    candidates |= (row & ((1u << block.columns) - 1)) << (r * leaf);
  }
  return candidates;
}

LocalPatch ClosestSearch::patch_of(const Leaf& block, std::size_t k) const {
  const std::size_t c = k % leaf, r = k / leaf;
  const auto z = [&](std::size_t row, std::size_t column) {
    return -surface_.max_depth() * double(block.depth[row][column]) - query_.z();
  };
  return {block.left[c], block.low[r], w_, h_, z(r, c), z(r, c + 1), z(r + 1, c), z(r + 1, c + 1)};
}

// Visits the cells of a block, nearest first. Returns whether any may still contain a later feature.
bool ClosestSearch::visit_leaf(int x, int y) {
  Leaf block;
  load(x, y, block);
  unsigned candidates = use_double_ ? bound_cells<double>(block) : bound_cells<float>(block),
           later = candidates;
  while (candidates != 0) {
    unsigned k = unsigned(std::countr_zero(candidates));
    for (unsigned rest = candidates & (candidates - 1); rest != 0; rest &= rest - 1) {
      const unsigned other = unsigned(std::countr_zero(rest));
      if (block.bound2[other] < block.bound2[k]) k = other;
    }
    if (block.bound2[k] >= best2_) break;
    candidates &= ~(1u << k);
    const int i = cell_index(block.i + int(k % leaf), surface_.width(), cell_i_) + tile_x_ * surface_.width(),
              j = cell_index(block.j + int(k / leaf), surface_.height(), cell_j_) +
                  tile_y_ * surface_.height();
    const LocalPatch patch = patch_of(block, k);
    // Under clamp one border cell appears several times.
    if (best_ && best_->i == i && best_->j == j && best_->patch.x == patch.x && best_->patch.y == patch.y)
      continue;
    if ((!cones_.empty() && block.inner && has_no_stationary_point(block, k)) ||
        consider(patch, i, j) == Verdict::rejected)
      later &= ~(1u << k);
  }
  return later != 0;
}

// Whether half the squared distance has no stationary point in the cell or its neighbours.
bool ClosestSearch::has_no_stationary_point(const Leaf& block, std::size_t k) const {
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
      const double z = -surface_.max_depth() * double(tiles.depth(from + at[c])) - query_.z();
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

ClosestSearch::Verdict ClosestSearch::consider(const LocalPatch& patch, int i, int j) {
  const PatchPoint at = nearest(patch);
  if (!(at.distance2 < best2_)) return Verdict::farther;
  const Best candidate{patch, at, i, j};
  // The nearest point of all always qualifies; later candidates are tested.
  if (!cones_.empty()) {
    const Vec3 direction = direction_of(candidate);
    if (cones_.contains(direction) || direction.dot(normal_of(candidate)) <= 0 ||
        !is_local_minimum(candidate))
      return Verdict::rejected;
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

// Whether a cell's nearest point is a local minimum of the distance over the whole relief. Within its own
// cell it is. If it lies on the cell's border, the distance must also increase into the neighbouring cell,
// which is tested here.
bool ClosestSearch::is_local_minimum(const Best& candidate) const {
  const auto& [patch, at, i, j] = candidate;
  const Vec3 there = patch.at(at.s, at.t);
  const auto falls = [&](double along, double step, double rise) {
    return along * step + there.z() * rise < -1e-9 * there.norm() * (std::abs(step) + std::abs(rise));
  };
  if (at.s <= 0 || at.s >= 1) {
    const int out = at.s <= 0 ? -1 : 1;
    const Cell neighbour = surface_.cell(i + out, j);
    const double rise = neighbour.z_s(at.t);
    if (falls(there.x(), out * w_, out * rise)) return false;
  }
  if (at.t <= 0 || at.t >= 1) {
    const int out = at.t <= 0 ? -1 : 1;
    const Cell neighbour = surface_.cell(i, j + out);
    const double rise = neighbour.z_t(at.s);
    if (falls(there.y(), out * h_, out * rise)) return false;
  }
  return true;
}

}  // namespace intaglio::surface
