#include "evaluate/reference.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "surface/recipes/builtin.h"
#include "surface/recipes/painter.h"

namespace intaglio::evaluate {

Reference::Reference(const surface::Recipe& recipe, const Vec2& size, double depth, int grid)
    : n_(grid), size_(size), spacing_(size / grid), depth_(depth), z_(std::size_t(grid) * std::size_t(grid)) {
  const surface::Painter painter(recipe);
  for (int j = 0; j < n_; ++j)
    for (int i = 0; i < n_; ++i)
      z_[std::size_t(j) * std::size_t(n_) + std::size_t(i)] =
          float(-depth * painter.at((i + 0.5) / n_, (j + 0.5) / n_).depth);
  measure_mean();
}

Reference::Reference(const surface::Surface& surface, int grid)
    : n_(grid),
      size_(surface.placement().size()),
      spacing_(size_ / grid),
      depth_(surface.max_depth()),
      z_(std::size_t(grid) * std::size_t(grid)) {
  for (int j = 0; j < n_; ++j)
    for (int i = 0; i < n_; ++i)
      z_[std::size_t(j) * std::size_t(n_) + std::size_t(i)] =
          float(surface.smooth({(i + 0.5) / n_, (j + 0.5) / n_}).height);
  measure_mean();
}

void Reference::measure_mean() {
  mean_ = std::accumulate(z_.begin(), z_.end(), 0.0) / double(z_.size());
}

double Reference::height(const Vec2& p) const {
  const double x = p.x() / spacing_.x() - 0.5, y = p.y() / spacing_.y() - 0.5;
  const double i = std::floor(x), j = std::floor(y);
  const surface::CatmullRom across(x - i), up(y - j);
  double sum = 0;
  for (int r = 0; r < 4; ++r) {
    double row = 0;
    for (int c = 0; c < 4; ++c) row += across.weight[std::size_t(c)] * at(int(i) + c - 1, int(j) + r - 1);
    sum += up.weight[std::size_t(r)] * row;
  }
  return sum;
}

Vec2 Reference::slope(const Vec2& p) const {
  const double x = p.x() / spacing_.x() - 0.5, y = p.y() / spacing_.y() - 0.5;
  const double i = std::floor(x), j = std::floor(y);
  const surface::CatmullRom across(x - i), up(y - j);
  Vec2 sum = Vec2::Zero();
  for (int r = 0; r < 4; ++r) {
    Vec2 row = Vec2::Zero();
    for (int c = 0; c < 4; ++c) {
      const double z = at(int(i) + c - 1, int(j) + r - 1);
      row += z * Vec2(across.slope[std::size_t(c)], across.weight[std::size_t(c)]);
    }
    sum += Vec2(up.weight[std::size_t(r)] * row.x(), up.slope[std::size_t(r)] * row.y());
  }
  return sum.cwiseQuotient(spacing_);
}

RestingBall Reference::rest_on(const Vec2& p, double radius) const {
  // The ball's centre is as low as no point q of the relief is inside: the maximum over q of
  // f(q) = height(q) + sqrt(radius^2 - |q - p|^2). At it the ball touches at right angles to the relief:
  // q = p + radius s / sqrt(1 + |s|^2) with the slope s there.
  const auto f = [&](const Vec2& q) {
    return height(q) + std::sqrt(std::max(0.0, radius * radius - (q - p).squaredNorm()));
  };
  Vec2 best = p;
  double highest = f(p);
  const auto refine = [&](Vec2 q) {
    for (int k = 0; k < 8; ++k) {
      const double value = f(q);
      if (value > highest) {
        highest = value;
        best = q;
      }
      const Vec2 s = slope(q);
      q += 0.7 * (p + radius / std::sqrt(1 + s.squaredNorm()) * s - q);
    }
  };
  refine(p);
  if (radius > 2 * spacing_.maxCoeff()) {
    refine(highest_point(p, radius));
  } else {
    for (int k = 0; k < 4; ++k) refine(p + 0.7 * radius * Vec2((k & 1) ? 1 : -1, (k & 2) ? 1 : -1));
  }
  return {highest - radius, {best.x(), best.y(), height(best)}, slope(best)};
}

Vec2 Reference::highest_point(const Vec2& p, double radius) const {
  const auto first = [&](int axis) { return int(std::ceil((p[axis] - radius) / spacing_[axis] - 0.5)); };
  const auto last = [&](int axis) { return int(std::floor((p[axis] + radius) / spacing_[axis] - 0.5)); };
  Vec2 best = p;
  double highest = height(p) + radius;
  for (int j = first(1); j <= last(1); ++j) {
    for (int i = first(0); i <= last(0); ++i) {
      const Vec2 q((i + 0.5) * spacing_.x(), (j + 0.5) * spacing_.y());
      const double rise2 = radius * radius - (q - p).squaredNorm();
      if (rise2 <= 0) continue;
      const double value = at(i, j) + std::sqrt(rise2);
      if (value <= highest) continue;
      highest = value;
      best = q;
    }
  }
  return best;
}

std::vector<Nearest> Reference::nearest(const Vec3& centre, double reach) const {
  const auto index = [&](double x, int axis, double by) {
    return int(std::floor((x + by) / spacing_[axis] - 0.5));
  };
  const int i0 = index(centre.x(), 0, -reach) - 1, i1 = index(centre.x(), 0, reach) + 2;
  const int j0 = index(centre.y(), 1, -reach) - 1, j1 = index(centre.y(), 1, reach) + 2;
  const int width = i1 - i0 + 1;
  static thread_local std::vector<double> square;
  square.resize(std::size_t(width) * std::size_t(j1 - j0 + 1));
  const auto square_at = [&](int i, int j) -> double& {
    return square[std::size_t(j - j0) * std::size_t(width) + std::size_t(i - i0)];
  };
  for (int j = j0; j <= j1; ++j) {
    const double y = (j + 0.5) * spacing_.y() - centre.y();
    for (int i = i0; i <= i1; ++i) {
      const double x = (i + 0.5) * spacing_.x() - centre.x(), z = at(i, j) - centre.z();
      square_at(i, j) = x * x + y * y + z * z;
    }
  }
  std::vector<Nearest> found;
  for (int j = j0 + 1; j < j1; ++j) {
    for (int i = i0 + 1; i < i1; ++i) {
      const double here = square_at(i, j);
      if (here > reach * reach) continue;
      bool is_least = true;
      for (int b = -1; b <= 1 && is_least; ++b)
        for (int a = -1; a <= 1; ++a)
          if ((a != 0 || b != 0) && square_at(i + a, j + b) < here) is_least = false;
      if (!is_least) continue;
      // The vertex of the parabola through its neighbours, along each axis.
      const auto vertex = [&](double before, double after) {
        const double bend = before - 2 * here + after;
        return bend > 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
      };
      const Vec2 q((i + 0.5 + vertex(square_at(i - 1, j), square_at(i + 1, j))) * spacing_.x(),
                   (j + 0.5 + vertex(square_at(i, j - 1), square_at(i, j + 1))) * spacing_.y());
      const Vec3 point(q.x(), q.y(), height(q));
      found.push_back({point, (centre - point).norm()});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const Nearest& a, const Nearest& b) { return a.distance < b.distance; });
  if (found.size() > 8) found.resize(8);
  return found;
}

Result<std::shared_ptr<const Reference>> make_reference(const std::string& texture,
                                                        const surface::Surface& surface, int grid) {
  const auto recipe = surface::find_recipe(texture);
  if (!recipe) return tl::unexpected(recipe.error());
  if (!*recipe) return std::make_shared<const Reference>(surface, grid);
  return std::make_shared<const Reference>(**recipe, surface.placement().size(), surface.max_depth(), grid);
}

}  // namespace intaglio::evaluate
