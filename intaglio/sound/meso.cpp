#include "intaglio/sound/meso.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace intaglio::sound {

namespace {

// One axis of the traversal: which texel, and at which fraction of the path the next one begins.
struct AxisWalk {
  int texel;
  int step;
  double next;     // fraction of the path at the next border
  double between;  // fraction of the path from one border to the next

  AxisWalk(double from, double to) : texel(static_cast<int>(std::floor(from))), step(to < from ? -1 : 1) {
    const double length = std::abs(to - from);
    const double border = step > 0 ? texel + 1 - from : from - texel;
    between = length > 0 ? 1 / length : std::numeric_limits<double>::infinity();
    next = length > 0 ? border / length : between;
  }
  void advance() {
    texel += step;
    next += between;
  }
};

}  // namespace

Vec3 normal_momentum(double mass, const Vec3& v_t, const Vec3& n_g, const Vec3& n_s) {
  return mass * (-v_t.dot(n_s) / std::max(n_g.dot(n_s), least_normal_cosine)) * n_g;
}

MesoWalk walk_texels(const surface::Surface& surface, const Vec2& uv0, const Vec2& uv1, double mass,
                     const Vec2& sweep, std::span<MesoImpulse> out) {
  const double width = surface.width(), height = surface.height();
  const Vec3 v_t(sweep.x(), sweep.y(), 0);
  AxisWalk u(uv0.x() * width, uv1.x() * width);
  AxisWalk v(uv0.y() * height, uv1.y() * height);
  const auto momentum_here = [&] {
    const Vec3 n_s = surface.texel_normal({(u.texel + 0.5) / width, (v.texel + 0.5) / height});
    return normal_momentum(mass, v_t, Vec3::UnitZ(), n_s).z();
  };
  MesoWalk walk;
  double momentum = momentum_here();
  while (std::min(u.next, v.next) < 1) {
    if (walk.count == out.size()) {
      walk.is_complete = false;
      break;
    }
    AxisWalk& axis = u.next < v.next ? u : v;
    const double fraction = axis.next;
    axis.advance();
    const double after = momentum_here();
    out[walk.count++] = {fraction, after - momentum};
    momentum = after;
  }
  return walk;
}

}  // namespace intaglio::sound
