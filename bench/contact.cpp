// Cost of a physics step: bench_contact [--json | --csv] [--quick] [--only=FLOOR]. One scene, one run,
// thread-CPU time.
//
// The scene: built-in bricks, 4 m a side, 8 cm deep, slopes up to 77 degrees; bodies of about 10 cm that move
// at up to 1 m/s, each for itself, none asleep; a plain Bullet world at 60 Hz with its own settings (10
// iterations); only the floor's shape changes. Floors: Bullet's plane; Bullet's triangle mesh and height
// field of the same texels; TexturedShape in all its ways. Bodies are thrown anew every half second. `us` is
// the time of a whole step, solver and all, divided by the bodies: median and 99th percentile over steps;
// `in` is how deep bodies were in the true relief (p95 over bodies and steps, spheres only), mm, of the
// floors that are relief or imply one. Textures above 1024 texels a side are upsampled (bench/brick.h).
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bench/floors.h"
#include "core/portable_math.h"
#include "intaglio/representation.h"
#include "surface/closest.h"

using namespace intaglio;
using namespace intaglio::dynamics;
using namespace intaglio::bench;

namespace {

constexpr double side = bench::floor_side, radius = 0.1;
constexpr int rate = FloorWorld::rate;

struct Row {
  std::string floor, body;
  int size, count;
  double us, p99, penetration_mm, build_ms, mib;
};

// Bodies of one shape on one floor.
class Run {
 public:
  Run(Floor& floor, btConvexShape& shape, int count) : floor_(floor), world_(floor) {
    for (int k = 0; k < count; ++k) world_.add(shape);
    is_sphere_ = shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE;
  }

  // Microseconds a body, of each step.
  Row measure(const std::string& what, int throws) {
    std::vector<double> times, depths;
    for (int n = 0; n < throws; ++n) {
      throw_bodies();
      for (int k = 0; k < rate / 2; ++k) {
        const double spent = world_.timed_step();
        if (k < 3) continue;  // pairs are made
        times.push_back(1e6 * spent / double(world_.bodies().size()));
        if (floor_.is_relief && is_sphere_) note_depths(depths);
      }
    }
    std::sort(times.begin(), times.end());
    std::sort(depths.begin(), depths.end());
    return {floor_.name,
            what,
            floor_.size,
            int(world_.bodies().size()),
            times[times.size() / 2],
            times[times.size() * 99 / 100],
            depths.empty() ? 0 : 1e3 * depths[depths.size() * 95 / 100],
            floor_.build_ms,
            floor_.bytes / 1048576};
  }

 private:
  void throw_bodies() {
    for (const auto& body : world_.bodies()) {
      const double x = random_.uniform(-0.3, 0.3) * side, z = random_.uniform(-0.3, 0.3) * side;
      const Vec3 at = start_over(floor_, x, z, is_sphere_ ? radius : 0.25);
      const double angle = random_.uniform(0, 2 * std::numbers::pi), speed = random_.uniform(0.2, 1);
      put(*body, at, {speed * std::cos(angle), 0, speed * std::sin(angle)}, Vec3::Zero());
    }
  }
  void note_depths(std::vector<double>& depths) const {
    for (const auto& body : world_.bodies()) {
      const btVector3& at = body->getWorldTransform().getOrigin();
      const auto nearest =
          closest_point(*floor_.surface, floor_.surface->placement().to_local({at.x(), at.y(), at.z()}));
      depths.push_back(nearest ? std::max(0.0, radius - nearest->distance) : 0);
    }
  }

  Floor& floor_;
  FloorWorld world_;
  bool is_sphere_ = false;
  Random random_{7};
};

struct Body {
  std::string name;
  std::unique_ptr<btConvexShape> shape;
};

std::unique_ptr<btConvexShape> hull() {
  auto out = std::make_unique<btConvexHullShape>();
  constexpr int points = 32;
  for (int k = 0; k < points; ++k) {
    const double y = 1 - (2 * k + 1.0) / points, angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
    const double across = std::sqrt(1 - y * y);
    out->addPoint(btScalar(0.15) * btVector3(btScalar(across * std::cos(angle)), btScalar(y),
                                             btScalar(across * std::sin(angle))));
  }
  return out;
}

class Bench {
 public:
  enum class Output { table, csv, json };

  // `only`: floors whose name holds that.
  Bench(bool quick, Output output, std::string only)
      : throws_(quick ? 2 : 8), output_(output), only_(std::move(only)) {
    bodies_.push_back({"sphere", std::make_unique<btSphereShape>(btScalar(radius))});
    bodies_.push_back(
        {"box", std::make_unique<btBoxShape>(btVector3(btScalar(0.15), btScalar(0.1), btScalar(0.2)))});
    bodies_.push_back({"hull of 32", hull()});
    if (output_ == Output::csv)
      fmt::print("floor,texels,body,count,us,us_p99,penetration_p95_mm,build_ms,mib\n");
    if (output_ == Output::table)
      fmt::print("{:<24}{:>6}  {:<11}{:>6}{:>10}{:>10}{:>9}{:>10}{:>9}\n", "floor", "texels", "body", "count",
                 "us", "p99", "in, mm", "built, ms", "MiB");
  }

  void spheres(Floor floor, const std::vector<int>& counts) {
    for (const int count : counts) add(floor, bodies_[0], count);
  }
  void shapes(Floor floor) {
    for (std::size_t k = 1; k < bodies_.size(); ++k) add(floor, bodies_[k], 10);
  }
  const std::vector<Row>& rows() const { return rows_; }

 private:
  void add(Floor& floor, Body& body, int count) {
    if (floor.name.find(only_) == std::string::npos) return;
    const int throws = std::max(1, throws_ * 10 / std::max(10, count / 10));
    rows_.push_back(Run(floor, *body.shape, count).measure(body.name, throws));
    const Row& r = rows_.back();
    if (output_ == Output::csv)
      fmt::print("\"{}\",{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}\n", r.floor, r.size, r.body, r.count,
                 r.us, r.p99, r.penetration_mm, r.build_ms, r.mib);
    if (output_ == Output::table)
      fmt::print("{:<24}{:>6}  {:<11}{:>6}{:>10.2f}{:>10.2f}{:>9.3f}{:>10.2f}{:>9.2f}\n", r.floor, r.size,
                 r.body, r.count, r.us, r.p99, r.penetration_mm, r.build_ms, r.mib);
    std::fflush(stdout);
  }

  int throws_;
  Output output_;
  std::string only_;
  std::vector<Body> bodies_;
  std::vector<Row> rows_;
};

constexpr ContactOptions flat{Representation::flat, ContactMethod::closest, NormalMethod::implied};
constexpr ContactOptions literal{Representation::normal, ContactMethod::closest, NormalMethod::literal};
constexpr ContactOptions implied{Representation::normal, ContactMethod::closest, NormalMethod::implied};
constexpr ContactOptions paper{Representation::relief, ContactMethod::directional, NormalMethod::implied};
constexpr ContactOptions ours{Representation::relief, ContactMethod::closest, NormalMethod::implied};

void measure(Bench& bench, bool quick) {
  const std::vector<int> all_counts = {1, 10, 100, 1000};
  const SharedSurface coarse = bricks(256), s = bricks(512);
  bench.spheres(plane(s), all_counts);
  bench.spheres(textured("plane, ours", s, flat), all_counts);
  bench.spheres(textured("normal map, literal", s, literal), all_counts);
  bench.spheres(textured("normal map, ours", s, implied), all_counts);
  bench.spheres(triangle_mesh(coarse), {100});
  bench.spheres(height_field(coarse), {100});
  bench.spheres(triangle_mesh(s), quick ? std::vector<int>{100} : all_counts);
  bench.spheres(height_field(s), quick ? std::vector<int>{100} : all_counts);
  bench.spheres(textured("relief, paper's", s, paper), all_counts);
  bench.spheres(textured("relief, ours", s, ours), all_counts);
  for (const int size : quick ? std::vector<int>{256, 1024} : std::vector<int>{256, 1024, 2048, 4096, 8192})
    bench.spheres(textured("relief, ours", bricks(size), ours), {100});
  for (const SharedSurface& texels : {coarse, s}) {
    bench.shapes(triangle_mesh(texels));
    bench.shapes(height_field(texels));
    bench.shapes(textured("relief, ours", texels, ours));
  }
  bench.shapes(textured("normal map, ours", s, implied));
  bench.shapes(plane(s));
}

void print_ratios(const std::vector<Row>& rows) {
  const auto find = [&](const std::string& floor, const std::string& body, int size, int count) {
    for (const Row& r : rows)
      if (r.floor == floor && r.body == body && r.size == size && r.count == count) return r.us;
    return std::nan("");
  };
  const auto ratio = [&](const std::string& what, double a, double b, double wanted) {
    fmt::print("{:<66}{:>8.3f}   wanted <= {}\n", what, a / b, wanted);
  };
  fmt::print("\nratios\n");
  ratio("100 spheres, 512: ours / Bullet mesh", find("relief, ours", "sphere", 512, 100),
        find("Bullet mesh", "sphere", 512, 100), 0.08);
  ratio("1000 spheres, 512: ours / 60 Hz step", find("relief, ours", "sphere", 512, 1000), 1e3 / 60, 1);
  ratio("box, 512: ours / Bullet mesh", find("relief, ours", "box", 512, 10),
        find("Bullet mesh", "box", 512, 10), 0.10);
  ratio("hull, 512: ours / Bullet mesh", find("relief, ours", "hull of 32", 512, 10),
        find("Bullet mesh", "hull of 32", 512, 10), 0.10);
  ratio("100 spheres: normal map, literal / plane, ours", find("normal map, literal", "sphere", 512, 100),
        find("plane, ours", "sphere", 512, 100), 1.15);
  ratio("100 spheres: normal map, ours / Bullet plane", find("normal map, ours", "sphere", 512, 100),
        find("Bullet plane", "sphere", 0, 100), 2);
  ratio("100 spheres: ours, 4096 / 512", find("relief, ours", "sphere", 4096, 100),
        find("relief, ours", "sphere", 512, 100), 2.5);
}

void print_json(const std::vector<Row>& rows) {
  fmt::print("[\n");
  for (const Row& r : rows) {
    fmt::print(
        "  {{\"floor\": \"{}\", \"texels\": {}, \"body\": \"{}\", \"count\": {}, \"us\": {:.4g}, \"us_p99\": {:.4g}, "
        "\"penetration_p95_mm\": {:.4g}, \"build_ms\": {:.4g}, \"mib\": {:.4g}}}{}\n",
        r.floor, r.size, r.body, r.count, r.us, r.p99, r.penetration_mm, r.build_ms, r.mib,
        &r == &rows.back() ? "" : ",");
  }
  fmt::print("]\n");
}

}  // namespace

int main(int argc, char** argv) {
  bool json = false, csv = false, quick = false;
  std::string only;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--json") == 0) {
      json = true;
    } else if (std::strcmp(argv[k], "--csv") == 0) {
      csv = true;
    } else if (std::strcmp(argv[k], "--quick") == 0) {
      quick = true;
    } else if (std::strncmp(argv[k], "--only=", 7) == 0) {
      only = argv[k] + 7;
    } else {
      fmt::print(stderr, "bench_contact: '{}' is none of --json, --csv, --quick, --only=FLOOR\n", argv[k]);
      return 2;
    }
  }
  Bench bench(quick, json ? Bench::Output::json : csv ? Bench::Output::csv : Bench::Output::table, only);
  measure(bench, quick);
  if (json) print_json(bench.rows());
  if (!json && !csv) print_ratios(bench.rows());
  return 0;
}
