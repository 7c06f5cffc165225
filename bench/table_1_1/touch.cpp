#include "bench/table_1_1/touch.h"

#include <array>
#include <cmath>
#include <functional>
#include <memory>

#include "bench/brick.h"
#include "bench/relief_triangles.h"
#include "bench/sliding_tip.h"
#include "bench/triangle_proxy.h"
#include "haptics/servo.h"
#include "intaglio/representation.h"
#include "mesh/mesh_placement.h"

namespace intaglio::bench {

namespace {

using namespace haptics;
constexpr int batch = 32;
constexpr double stiffness = 800, friction = 0.3;
constexpr double reach = 0.01;  // m, to which a mesh is searched

// One way to feel the path: `tick` returns the force upwards, N.
struct Way {
  std::string representation, method;
  const std::vector<Vec3>* path;
  std::function<double(const Vec3&)> tick;
  std::vector<double> us = {};
  double touching = 0, force = 0, count = 0;
};

struct Felt {
  std::vector<Vec3> path, normal_path;  // below the relief, and below a normal map's slopes
  std::vector<std::unique_ptr<LedDevice>> devices;
  std::vector<std::shared_ptr<const surface::Surface>> surfaces;
  std::vector<Way> ways;
};

void add_servo(Felt& felt, const std::string& name, const std::shared_ptr<const surface::Surface>& s,
               std::shared_ptr<const Solid> solid, Representation representation) {
  ServoOptions options;
  options.representation = representation;
  options.spring.stiffness = stiffness;
  options.friction = friction;
  const std::vector<Vec3>& path = representation == Representation::normal ? felt.normal_path : felt.path;
  felt.devices.push_back(std::make_unique<LedDevice>(path));
  LedDevice& device = *felt.devices.back();
  auto servo =
      std::make_shared<PenServo>(solid ? PenServo(s, std::move(solid), options) : PenServo(s, options));
  felt.ways.push_back({name, "servo", &path, [servo, &device](const Vec3&) {
                         const ServoSample sample = servo->tick(device);
                         return sample.touching ? sample.wanted.y() : 0.0;
                       }});
}

void add_proxies(Felt& felt, const std::string& name, const std::shared_ptr<const surface::Surface>& s) {
  const auto k = ContactSprings::for_felt_stiffness(stiffness);
  const auto slab = std::make_shared<TexturedSlab>(s, SolidOptions{});
  const auto proxy = std::make_shared<Proxy>();
  if (name == "fine mesh") {
    felt.ways.push_back({"relief map", "proxy", &felt.path,
                         [=](const Vec3& x) { return proxy->move(*slab, x, k, friction).force.y(); }});
  }
  const auto mesh = std::make_shared<TriangleProxy>(*s);
  const auto state = std::make_shared<TriangleProxy::State>();
  felt.ways.push_back(
      {name, "proxy", &felt.path, [=](const Vec3& x) { return mesh->move(*state, x, stiffness).y(); }});
  felt.surfaces.push_back(s);
}

Result<void> add_mesh(Felt& felt, const std::string& name, const std::shared_ptr<const surface::Surface>& s) {
  auto placement = surface::MeshPlacement::make(relief_triangles(*s), name);
  if (!placement) return tl::unexpected(placement.error());
  SolidOptions options;
  options.representation = Representation::flat;
  add_servo(felt, name, s, std::make_shared<TexturedMesh>(s, std::move(*placement), reach, options),
            Representation::relief);
  add_proxies(felt, name, s);
  return {};
}

void play(Way& way) {
  const std::vector<Vec3>& path = *way.path;
  for (std::size_t k = 0; k + batch <= path.size(); k += batch) {
    std::array<double, batch> force;
    const double start = cpu_seconds();
    for (std::size_t n = 0; n < batch; ++n) force[n] = way.tick(path[k + n]);
    way.us.push_back(1e6 * (cpu_seconds() - start) / batch);
    for (const double f : force) {
      way.count += 1;
      if (f == 0) continue;
      way.touching += 1;
      way.force += f;
    }
  }
}

}  // namespace

Result<std::vector<TouchCost>> measure_touch(int ticks, int rounds) {
  const auto fine = std::make_shared<const surface::Surface>(brick(512));
  const auto coarse = std::make_shared<const surface::Surface>(brick(256));
  Felt felt;
  felt.path = sliding_path(fine, ticks);
  felt.normal_path = sliding_path(fine, ticks, Representation::normal);
  add_servo(felt, "normal map", fine, nullptr, Representation::normal);
  add_servo(felt, "relief map", fine, nullptr, Representation::relief);
  for (const auto& [name, s] :
       {std::pair<std::string, std::shared_ptr<const surface::Surface>>{"coarse mesh", coarse},
        {"fine mesh", fine}}) {
    if (auto added = add_mesh(felt, name, s); !added) return tl::unexpected(added.error());
  }
  for (int round = 0; round < rounds; ++round)
    for (Way& way : felt.ways) play(way);
  std::vector<TouchCost> out;
  for (const Way& way : felt.ways) {
    out.push_back({way.representation, way.method, summary(way.us), way.touching / way.count,
                   way.force / std::max(1.0, way.touching)});
  }
  return out;
}

}  // namespace intaglio::bench
