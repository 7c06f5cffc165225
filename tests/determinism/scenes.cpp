#include "tests/determinism/scenes.h"

#include <unistd.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "contact/polyhedron.h"
#include "core/file.h"
#include "core/portable_math.h"
#include "intaglio/image.h"
#include "mesh/triangle_mesh.h"
#include "surface/import.h"
#include "surface/recipes/builtin.h"

namespace intaglio::determinism {

namespace {

template <class T>
T demand(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().message().c_str());
    std::exit(2);
  }
  return std::move(*result);
}

constexpr double depth = 0.02;  // m

std::shared_ptr<const sound::ModalModel> model(int seed, double lowest, double mass) {
  Random random(std::uint64_t(seed));
  auto out = std::make_shared<sound::ModalModel>();
  out->name = "made by hand";
  out->material = demand(find_material("brick"));
  out->mass = mass;
  constexpr int modes = 100;
  double hertz = lowest;
  for (int m = 0; m < modes; ++m) {
    const double omega = 2 * std::numbers::pi * hertz;
    out->angular_frequency.push_back(omega);
    out->damping.push_back(0.5 * (6 + 2e-7 * omega * omega));
    out->radiation.push_back(random.uniform(0.1, 1));
    hertz *= random.uniform(1.01, 1.06);
  }
  // A tetrahedron.
  out->points = {{0.05, 0.05, 0.05}, {0.05, -0.05, -0.05}, {-0.05, 0.05, -0.05}, {-0.05, -0.05, 0.05}};
  out->triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  out->grid = sound::TriangleGrid(out->points, out->triangles);
  for (int k = 0; k < 4 * 3 * modes; ++k)
    out->shapes.push_back(float(random.uniform(-1, 1) / std::sqrt(mass)));
  return out;
}

}  // namespace

void add(Hash& hash, const ContactEvent& e) {
  hash.add(e.time);
  hash.add(e.body);
  hash.add(e.other);
  hash.add(std::uint8_t(e.phase));
  hash.add(e.texture);
  hash.add(e.duration);
  hash.add(std::isnan(e.touch_age) ? -1 : e.touch_age);
  const Vec2 none = Vec2::Zero();
  for (const Vec2& v : {e.uv, e.sweep.value_or(none), e.own ? e.own->uv : none, e.own ? e.own->sweep : none})
    add(hash, v);
  for (const Vec3& v : {e.point, e.n_g, e.n_s, e.v_t, e.spin, e.impulse}) add(hash, v);
  add(hash, e.body_pose);
}

std::shared_ptr<const surface::Surface> floor(const std::string& material, int texels) {
  const surface::BuiltinRecipe recipe = demand(surface::find_builtin(material));
  return std::make_shared<const surface::Surface>(surface::to_texels(surface::make_texture(recipe, texels)),
                                                  surface::Placement(Vec3::Zero(), Quat::Identity(), 1, 1),
                                                  depth, surface::Edge::wrap);
}

surface::ReliefMesh skin(const std::string& material, double radius, bool is_bowl) {
  auto mesh = is_bowl ? surface::make_bowl(radius, 32, 12) : surface::make_sphere(radius, 16, 10);
  const surface::BuiltinRecipe recipe = demand(surface::find_builtin(material));
  auto texture = std::make_shared<const surface::Surface>(
      surface::to_texels(surface::make_texture(recipe, 64)),
      surface::Placement(Vec3::Zero(), Quat::Identity(), 1, 1), 0.03 * radius, surface::Edge::wrap);
  return demand(
      surface::ReliefMesh::make(std::move(texture), demand(surface::MeshPlacement::make(std::move(mesh)))));
}

surface::Texels imported(const std::string& material) {
  const Image16 whole = surface::make_texture(demand(surface::find_builtin(material)), 128).relief;
  Image16 normal(120, 90, 3), height(120, 90, 1);
  for (int y = 0; y < normal.height; ++y) {
    for (int x = 0; x < normal.width; ++x) {
      for (int c = 0; c < 3; ++c) normal.at(x, y, c) = whole.at(x, y, c);
      height.at(x, y, 0) = std::uint16_t(65535 - whole.at(x, y, 3));
    }
  }
  std::string folder = (std::filesystem::temp_directory_path() / "intaglio_determinism_XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) std::exit(2);
  const auto write = [&](const char* name, const Image16& image) {
    if (auto done = write_file(std::filesystem::path(folder) / name, encode_png(image)); !done) std::exit(2);
  };
  write("it_normal.png", normal);
  write("it_height.png", height);
  surface::ImportOptions options;
  options.edge = surface::Edge::clamp;
  auto out = surface::import_texture(folder, options);
  std::filesystem::remove_all(folder);
  return std::move(demand(std::move(out)).texels);
}

std::vector<NamedShape> shapes() {
  Random random(1);
  std::vector<Vec3> corners;
  for (int k = 0; k < 20; ++k) corners.push_back(0.06 * any_vector(random, 1).normalized());
  return {{"sphere", contact::Sphere{0.05}},
          {"box", contact::Box{{0.06, 0.04, 0.05}}},
          {"hull", contact::ConvexHull{demand(contact::convex_hull(corners))}},
          {"capsule", contact::Capsule{0.03, 0.04}},
          {"cylinder", contact::Cylinder{0.05, 0.03}}};
}

std::vector<sound::SoundBody> sounding(std::shared_ptr<const surface::Surface> surface, int count) {
  std::vector<sound::SoundBody> out(1);
  out[0].id = floor_body;
  out[0].model = model(1, 60, 50);
  out[0].is_fixed = true;
  out[0].textures = {std::move(surface)};
  for (int k = 1; k <= count; ++k) {
    sound::SoundBody body;
    body.id = static_cast<BodyId>(k);
    body.model = model(1 + k, 400 + 50 * k, 0.5);
    body.mass = 0.5;
    body.radius_of_curvature = 0.05;
    out.push_back(std::move(body));
  }
  return out;
}

}  // namespace intaglio::determinism
