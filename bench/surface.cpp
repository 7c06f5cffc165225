// Cost of the surface's queries: bench_surface [--json] [SIZE...], sizes in texels a side, 256 to 8192 by
// default.
//
// The texture is the built-in brick, 1 m a side and 2 cm deep, up to 1024 x 1024 as generated and above that
// bicubically upsampled from there (the brick's noise ends at 192 waves a side, so nothing is missing). Times
// are CPU time of the thread, median and 99th percentile over batches of 128 queries, after one pass to warm
// up; positions are random, so at large sizes texels come from memory, not from a cache (`path` is a slow
// circle, as a body or tip goes). Poses: `contact` is a point 0 to 5 cm above the relief; `random` is within
// 20 cm around the rectangle and 50 cm above; `sphere` asks what contact asks: a ball of 2 to 5 cm near
// touching, features 20 degrees apart.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "bench/arguments.h"
#include "bench/brick.h"
#include "core/portable_math.h"
#include "surface/closest.h"
#include "surface/import.h"
#include "surface/ray.h"
#include "surface/surface.h"

using namespace intaglio;
using namespace intaglio::surface;
using bench::brick;
using bench::cpu_seconds;

namespace {

volatile double sink = 0;

struct Row {
  int size;
  std::string what;
  double median, p99;  // in `unit`
  std::string unit;
};

// Median and p99 of the time of one query in microseconds, over batches. `query(k)` answers pose k and
// returns some number of the answer. All poses are asked once before the clock runs, then three times.
Row timed(int size, const std::string& what, int queries, const std::function<double(int)>& query) {
  // Reading the clock costs 0.6 us: 128 queries make that 5 ns a query.
  const int batch = std::min(128, std::max(1, queries / 16));
  std::vector<double> times;
  for (int pass = 0; pass < 4; ++pass) {
    for (int k = 0; k + batch <= queries; k += batch) {
      double sum = 0;
      const double start = cpu_seconds();
      for (int n = 0; n < batch; ++n) sum += query(k + n);
      if (pass > 0) times.push_back((cpu_seconds() - start) / batch * 1e6);
      sink = sink + sum;
    }
  }
  std::sort(times.begin(), times.end());
  return {size, what, times[times.size() / 2], times[times.size() * 99 / 100], "us"};
}

// The nearest point by trying every cell that could hold it.
double brute_distance(const Surface& s, const Vec3& p) {
  const auto [under_i, under_j] = s.cell_at(p.x(), p.y());
  double best2 = nearest(SeenPatch(s.cell(under_i, under_j), p)).distance2;
  const double reach = std::sqrt(best2);
  const auto [i0, j0] = s.cell_at(p.x() - reach, p.y() - reach);
  const auto [i1, j1] = s.cell_at(p.x() + reach, p.y() + reach);
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) {
      const Cell c = s.cell(i, j);
      const Vec3 low(c.x0, c.y0, c.min_z()), high(c.x1, c.y1, c.max_z());
      if ((p - p.cwiseMax(low).cwiseMin(high)).squaredNorm() < best2)
        best2 = std::min(best2, nearest(SeenPatch(c, p)).distance2);
    }
  }
  return std::sqrt(best2);
}

struct Poses {
  std::vector<Vec2> uv;
  std::vector<Vec3> contact, random, path, sphere, origin, direction;
  std::vector<double> radius;

  Poses(const Surface& s, int count) {
    Random r(1);
    for (int k = 0; k < count; ++k) {
      uv.emplace_back(r.uniform(), r.uniform());
      contact.emplace_back(r.uniform(), r.uniform(), 0);
      contact.back().z() = r.uniform(0, 0.05) - s.depth(s.placement().uv(contact.back()));
      path.emplace_back(0.5 + 0.3 * std::cos(k / 300.0), 0.5 + 0.3 * std::sin(k / 300.0), 0);
      path.back().z() = r.uniform(0, 0.05) - s.depth(s.placement().uv(path.back()));
      random.emplace_back(r.uniform(-0.2, 1.2), r.uniform(-0.2, 1.2), r.uniform(-0.02, 0.5));
      radius.push_back(r.uniform(0.02, 0.05));
      // Moved up or down to where the ball is 2 mm apart at most, or dips in by as much.
      Vec3 centre(r.uniform(), r.uniform(), 0.05);
      for (int n = 0; n < 20; ++n) centre.z() += radius.back() - closest_point(s, centre)->distance;
      sphere.push_back(centre + Vec3(0, 0, r.uniform(-0.002, 0.002)));
      origin.emplace_back(r.uniform(-0.5, 1.5), r.uniform(-0.5, 1.5), r.uniform(0.2, 1));
      direction.push_back(Vec3(r.uniform(), r.uniform(), -0.01) - origin.back());
    }
  }
};

double pyramid_milliseconds(const Surface& s) {
  const std::vector<float> depths = s.depth_texture();
  double best = 1e9;
  for (int n = 0; n < 5; ++n) {
    const double start = cpu_seconds();
    const Pyramid pyramid(depths, s.grid());
    best = std::min(best, (cpu_seconds() - start) * 1e3);
    sink = sink + pyramid.whole().deep;
  }
  return best;
}

void measure(int size, std::vector<Row>& rows) {
  const Surface s = brick(size);
  const Poses p(s, 20000);
  const auto n = int(p.uv.size());
  const double texel = s.texel_u();
  const auto at = [](int k) { return std::size_t(k); };
  const auto add = [&](const std::string& what, int count, const std::function<double(int)>& query) {
    rows.push_back(timed(size, what, count, query));
  };
  add("sample, footprint 0", n, [&](int k) {
    const Sample x = s.sample(p.uv[at(k)]);
    return x.depth + x.normal.x() + x.gradient.x();
  });
  add("sample, footprint 0, path", n, [&](int k) {
    const Sample x = s.sample(s.placement().uv(p.path[at(k)]));
    return x.depth + x.normal.x() + x.gradient.x();
  });
  add("sample, 6 texels", n, [&](int k) {
    const Sample x = s.sample(p.uv[at(k)], 6 * texel);
    return x.depth + x.normal.x() + x.gradient.x() + x.roughness;
  });
  add("smooth, footprint 0", n, [&](int k) {
    const Smooth x = s.smooth(p.uv[at(k)], 0);
    return x.height + x.gradient.x();
  });
  add("smooth, 6 texels", n, [&](int k) {
    const Smooth x = s.smooth(p.uv[at(k)], 6 * texel);
    return x.height + x.gradient.x();
  });
  add("normal", n, [&](int k) { return s.normal(p.uv[at(k)]).x(); });
  add("extent, 2 cm square", n,
      [&](int k) { return extent(s, p.uv[at(k)], p.uv[at(k)] + Vec2(0.02, 0.02)).high; });
  add("closest_point, contact", n, [&](int k) { return closest_point(s, p.contact[at(k)])->distance; });
  const double ours = rows.back().median;
  add("closest_point, path", n, [&](int k) { return closest_point(s, p.path[at(k)])->distance; });
  add("closest_point, random", n, [&](int k) { return closest_point(s, p.random[at(k)])->distance; });
  add("closest_features, sphere", n, [&](int k) {
    std::array<Feature, 4> features;
    return double(closest_features(s, p.sphere[at(k)], p.radius[at(k)] + 0.002, 0.35, features));
  });
  add("ray hit", n, [&](int k) {
    const auto hit = intersect(s, p.origin[at(k)], p.direction[at(k)], 0, 10);
    return hit ? hit->t : 0;
  });
  add("closest_point, contact, brute force", size <= 1024 ? 800 : 48,
      [&](int k) { return brute_distance(s, p.contact[at(k)]); });
  const double ratio = rows.back().median / ours;
  rows.push_back({size, "brute force / closest_point", ratio, ratio, ""});
  const double build = pyramid_milliseconds(s);
  rows.push_back({size, "pyramid built", build, build, "ms"});
  const double bytes = double(s.memory_bytes() - s.colour().data.size());
  rows.push_back({size, "memory without colour", bytes / 1048576, bytes / 1048576, "MiB"});
  rows.push_back({size, "memory, bytes a texel", bytes / size / size, bytes / size / size, ""});
}

}  // namespace

int main(int argc, char** argv) {
  const auto given = bench::arguments(argc, argv, "bench_surface", 1, {256, 512, 1024, 2048, 4096, 8192});
  if (!given) return 2;
  const bool json = given->json;
  const std::vector<int>& sizes = given->sizes;
  std::vector<Row> rows;
  if (!json) fmt::print("{:>6}  {:<38}{:>10}{:>10}\n", "size", "what", "median", "p99");
  for (const int size : sizes) {
    const std::size_t first = rows.size();
    measure(size, rows);
    for (std::size_t k = first; k < rows.size() && !json; ++k) {
      fmt::print("{:>6}  {:<38}{:>10.3f}{:>10.3f} {}\n", rows[k].size, rows[k].what, rows[k].median,
                 rows[k].p99, rows[k].unit);
    }
    std::fflush(stdout);
  }
  if (json) {
    fmt::print("[\n");
    for (std::size_t k = 0; k < rows.size(); ++k) {
      fmt::print(
          "  {{\"size\": {}, \"what\": \"{}\", \"median\": {:.6g}, \"p99\": {:.6g}, \"unit\": \"{}\"}}{}\n",
          rows[k].size, rows[k].what, rows[k].median, rows[k].p99, rows[k].unit,
          k + 1 < rows.size() ? "," : "");
    }
    fmt::print("]\n");
  }
  return 0;
}
