// Cost of a haptic tick, and the energy it generates: bench_haptics [--json] [SIZE...], sizes in texels a
// side, 512 and 4096 by default.
//
// A tip slides over the built-in brick (1 m, 2 cm deep; above 1024 x 1024 bicubically upsampled from there),
// 1 to 6 mm deep, at up to 0.4 m/s on a curve that visits all of it, so that texels come from memory. The
// whole update is timed: device, proxy, friction, damping, passivity, guard. Beside it, on the same path: the
// paper's method with a plane every tick (its 60 Hz would hide the cost) and a finger proxy on a triangle
// mesh of the 512 x 512 texels (Zilles and Salisbury's god object, constraint planes of up to three
// triangles, neighbours by grid). Times are CPU time of the thread, median and 99th percentile of batches of
// 32 ticks; `single` times each tick by itself, with the clock's own cost taken off. The energy table is work
// on the hand over 400 closed loops, K = 800 N/m, on a brick of 10 cm (tests/haptics/closed_loops.h).
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "bench/arguments.h"
#include "bench/brick.h"
#include "bench/sliding_tip.h"
#include "bench/triangle_proxy.h"
#include "core/portable_math.h"
#include "haptics/servo.h"
#include "intaglio/representation.h"
#include "tests/haptics/closed_loops.h"

using namespace intaglio;
using namespace intaglio::haptics;
using bench::cpu_seconds;

namespace {

volatile double sink = 0;

struct Row {
  int size;
  std::string what;
  double median, p99, most;
  std::string unit;
};

Row summary(int size, const std::string& what, std::vector<double> values, const std::string& unit) {
  std::sort(values.begin(), values.end());
  return {size, what, values[values.size() / 2], values[values.size() * 99 / 100], values.back(), unit};
}

Row timed(int size, const std::string& what, int ticks, int batch, const std::function<double(int)>& tick) {
  std::vector<double> times;
  double clock_cost = 1;
  for (int k = 0; k < 1000 && batch == 1; ++k) {
    const double start = cpu_seconds();
    clock_cost = std::min(clock_cost, cpu_seconds() - start);
  }
  if (batch > 1) clock_cost = 0;
  for (int k = 0; k + batch <= ticks; k += batch) {
    double sum = 0;
    const double start = cpu_seconds();
    for (int n = 0; n < batch; ++n) sum += tick(k + n);
    times.push_back((cpu_seconds() - start - clock_cost) / batch * 1e6);
    sink = sink + sum;
  }
  return summary(size, what, std::move(times), "us");
}

std::shared_ptr<const surface::Surface> brick(int size, double side) {
  return std::make_shared<const surface::Surface>(bench::brick(size, side));
}

void measure(int size, std::vector<Row>& rows) {
  const auto s = brick(size, 1);
  constexpr int ticks = 200000;
  const auto path = bench::sliding_path(s, ticks);
  const auto whole = [&](HapticMethod method, int batch, const std::string& what) {
    ServoOptions options;
    options.method = method;
    options.plane_rate = 1000;
    options.spring.stiffness = 800;
    bench::LedDevice device(path);
    PenServo servo(s, options);
    rows.push_back(timed(size, what, ticks, batch, [&](int) {
      servo.tick(device);
      return device.last();
    }));
  };
  whole(HapticMethod::potential, 32, "whole tick, potential");
  whole(HapticMethod::potential, 1, "whole tick, potential, single");
  whole(HapticMethod::plane, 32, "whole tick, plane (the paper's)");
  const TexturedSlab slab(s, {});
  Proxy proxy;
  int samples = 0;
  rows.push_back(timed(size, "proxy alone", ticks, 32, [&](int k) {
    const auto c = proxy.move(slab, path[std::size_t(k)], ContactSprings::for_felt_stiffness(800), 0.3);
    samples += c.samples;
    return c.force.y();
  }));
  rows.push_back({size, "samples of the relief a tick", double(samples) / ticks, 0, 0, ""});
  if (size > 512) return;
  const bench::TriangleProxy mesh(*s);
  bench::TriangleProxy::State state;
  rows.push_back(timed(size, fmt::format("finger proxy on {} triangles", mesh.triangle_count()), ticks, 32,
                       [&](int k) { return mesh.move(state, path[std::size_t(k)], 800).y(); }));
}

// How far the proxy is from where it would settle, in newtons.
void measure_convergence(std::vector<Row>& rows) {
  const auto s = brick(512, 1);
  const auto path = bench::sliding_path(s, 50000);
  const TexturedSlab slab(s, {});
  const auto k = ContactSprings::for_felt_stiffness(800);
  Proxy proxy;
  std::vector<double> off;
  for (const Vec3& x : path) {
    const Vec3 force = proxy.move(slab, x, k, 0).force;
    Proxy settled = proxy;
    Vec3 last = force;
    for (int n = 0; n < 50; ++n) last = settled.move(slab, x, k, 0).force;
    off.push_back((force - last).norm());
  }
  rows.push_back(summary(512, "force not yet converged", std::move(off), "N"));
}

void measure_energy(std::vector<Row>& rows) {
  const auto s = brick(512, 0.1);
  const TexturedSlab slab(s, {Representation::relief, 0.001, 0.02});
  const auto k = ContactSprings::for_felt_stiffness(800);
  const bench::TriangleProxy mesh(*s);
  std::vector<double> ours, rubbing, plane, literal, finger;
  Random random(7);
  for (int n = 0; n < 400; ++n) {
    const auto path = tests::closed_loop(*s, random, 10e-6);
    Proxy free, stuck;
    ours.push_back(tests::work_round(tests::refined(path, 10), 0.05, [&](const Vec3& x, const Vec3&, double) {
      return free.move(slab, x, k, 0).force;
    }));
    rubbing.push_back(tests::work_round(path, 0.05, [&](const Vec3& x, const Vec3& v, double) {
      const auto c = stuck.move(slab, x, k, 0.4);
      return Vec3(c.force + std::max(-c.force.dot(c.normal), -v.dot(c.normal)) * c.normal);
    }));
    HeldPlane held(60), every(1e9);
    plane.push_back(tests::work_round(path, 0.05, [&](const Vec3& x, const Vec3& v, double dt) {
      return held.move(*s, Representation::relief, x, v, {800, 0}, dt).force;
    }));
    literal.push_back(tests::work_round(path, 0.05, [&](const Vec3& x, const Vec3& v, double dt) {
      return every.move(*s, Representation::normal, x, v, {800, 0}, dt).force;
    }));
    bench::TriangleProxy::State state;
    finger.push_back(tests::work_round(
        path, 0.05, [&](const Vec3& x, const Vec3&, double) { return mesh.move(state, x, 800); }));
  }
  const auto add = [&](const std::string& what, std::vector<double> work) {
    for (double& w : work) w *= 1e3;
    rows.push_back(summary(512, "work a loop: " + what, std::move(work), "mJ"));
  };
  add("potential", ours);
  add("potential, friction 0.4, damping 1", rubbing);
  add("plane at 60 Hz, Eq. 1.3", plane);
  add("literal normals, flat base", literal);
  add("finger proxy on triangles", finger);
}

void print(const std::vector<Row>& rows, bool json) {
  if (!json) {
    fmt::print("{:>6}  {:<46}{:>12}{:>12}{:>12}\n", "size", "what", "median", "p99", "most");
    for (const Row& r : rows) {
      fmt::print("{:>6}  {:<46}{:>12.6f}{:>12.6f}{:>12.6f} {}\n", r.size, r.what, r.median, r.p99, r.most,
                 r.unit);
    }
    return;
  }
  fmt::print("[\n");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& r = rows[k];
    fmt::print(
        "  {{\"size\": {}, \"what\": \"{}\", \"median\": {:.6g}, \"p99\": {:.6g}, \"most\": {:.6g}, \"unit\": "
        "\"{}\"}}{}\n",
        r.size, r.what, r.median, r.p99, r.most, r.unit, k + 1 < rows.size() ? "," : "");
  }
  fmt::print("]\n");
}

}  // namespace

int main(int argc, char** argv) {
  const auto given = bench::arguments(argc, argv, "bench_haptics", 16, {512, 4096});
  if (!given) return 2;
  const bool json = given->json;
  const std::vector<int>& sizes = given->sizes;
  std::vector<Row> rows;
  for (const int size : sizes) measure(size, rows);
  measure_convergence(rows);
  measure_energy(rows);
  print(rows, json);
  return 0;
}
