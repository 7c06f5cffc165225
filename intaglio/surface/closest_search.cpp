#include "intaglio/surface/closest_search.h"

#include <algorithm>
#include <cmath>
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

}  // namespace intaglio::surface
