#include "bench/table_1_1/modal.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "bench/brick.h"
#include "bench/table_1_1/child.h"
#include "intaglio/bake.h"
#include "intaglio/material.h"
#include "intaglio/triangle_mesh.h"
#include "sound/api.h"
#include "sound/bake/bake.h"
#include "sound/bake/fem/block_lanczos.h"
#include "sound/bake/fem/body_surface.h"
#include "sound/bake/fem/elastic_system.h"
#include "sound/bake/fem/modes.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/bake/merge_modes.h"
#include "sound/modal_bank.h"

#ifdef INTAGLIO_HAS_LAPACK
extern "C" void dsygvd_(const int* type, const char* vectors, const char* triangle, const int* n, double* a,
                        const int* lda, double* b, const int* ldb, double* values, double* work,
                        const int* work_size, int* whole_work, const int* whole_work_size, int* info);
#endif

namespace intaglio::bench {

namespace {

constexpr double tile_side = 0.3, tile_thickness = 0.02;  // m
constexpr int modes = 100;
constexpr double merge_db = 0.5;  // as intaglio::bake
// m. The default, one element through the thickness, loses the tile where its grooves are.
constexpr double mesh_element = tile_thickness / 2;

const Material& ceramic() {
  static const Material material = *find_material("ceramic");
  return material;
}

sound::BakeOptions bake_options() {
  sound::BakeOptions options;
  options.modes.count = modes;
  return options;
}

double surface_bytes(std::size_t vertices, std::size_t triangles) {
  return 32.0 * double(vertices) + 12.0 * double(triangles);
}

double tet_bytes(const sound::TetMesh& mesh) {
  return 12.0 * double(mesh.nodes.size()) + 40.0 * double(mesh.tets.size());
}

// Fills in what the model of an analysis holds at run time.
void measure_runtime(const sound::ModalModel& model, ModalCost& cost) {
  const double before = allocated_bytes();
  const auto copy = std::make_unique<sound::ModalModel>(model);
  const auto bank = std::make_unique<sound::ModalBank>(*copy, 44'100.0);
  cost.runtime_bytes = allocated_bytes() - before;
  cost.modes = model.modes();
}

// `analyse` returns a Result of a model.
template <class Analyse>
ModalCost measured(ModalCost cost, const Analyse& analyse) {
  const PeakMemory peak;
  const double start = cpu_seconds();
  auto model = analyse();
  if (!model) {
    std::fprintf(stderr, "bench_table_1_1: %s\n", model.error().message().c_str());
    _exit(1);
  }
  if (model->modes_before_merging == 0) sound::merge_modes(*model, merge_db);
  cost.seconds = cpu_seconds() - start;
  cost.offline_bytes = peak.bytes();
  measure_runtime(*model, cost);
  return cost;
}

void add_square(TriangleMesh& mesh, int a, int b, int c, int d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

// Vertices on a grid of n x n squares, upwards; `height` of vertex (i, j).
template <class Height>
TriangleMesh sheet(int n, const Height& height) {
  TriangleMesh mesh;
  const double step = tile_side / n;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.positions.emplace_back(i * step, j * step, height(i, j));
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      add_square(mesh, a, a + 1, a + n + 2, a + n + 1);
    }
  }
  return mesh;
}

// Closed: the relief above, walls, and a floor about its middle. Its top has texels x texels vertices.
TriangleMesh tile(int texels) {
  const surface::Surface relief = brick(texels, tile_side);
  const int n = texels - 1;
  TriangleMesh mesh = sheet(n, [&](int i, int j) { return relief.texel_z(i, j); });
  std::vector<int> rim;  // counter-clockwise from above
  for (int k = 0; k < n; ++k) rim.push_back(k);
  for (int k = 0; k < n; ++k) rim.push_back(k * texels + n);
  for (int k = 0; k < n; ++k) rim.push_back(n * texels + n - k);
  for (int k = 0; k < n; ++k) rim.push_back((n - k) * texels);
  const int below = int(mesh.positions.size()), count = int(rim.size()), middle = below + count;
  for (const int vertex : rim) {
    const Vec3 top = mesh.positions[std::size_t(vertex)];
    mesh.positions.emplace_back(top.x(), top.y(), -tile_thickness);
  }
  mesh.positions.emplace_back(tile_side / 2, tile_side / 2, -tile_thickness);
  for (int k = 0; k < count; ++k) {
    const int next = (k + 1) % count;
    add_square(mesh, below + k, below + next, rim[std::size_t(next)], rim[std::size_t(k)]);
    mesh.triangles.push_back({middle, below + next, below + k});
  }
  return mesh;
}

ModalCost bake_mesh(const TriangleMesh& mesh) {
  ModalCost cost;
  cost.vertices = double(mesh.positions.size());
  cost.unknowns = 3 * cost.vertices;  // where every vertex is a node
  cost.mesh_bytes = surface_bytes(mesh.positions.size(), mesh.triangles.size());
  return measured(cost, [&]() -> Result<sound::ModalModel> {
    const auto model = bake(mesh, "ceramic", {.modes = modes, .element_size = mesh_element});
    if (!model) return tl::unexpected(model.error());
    return *model->impl().model;
  });
}

ModalCost bake_elements(const sound::TetMesh& mesh) {
  ModalCost cost;
  cost.vertices = double(mesh.nodes.size());
  cost.unknowns = 3 * cost.vertices;
  cost.elements = double(mesh.tets.size());
  cost.mesh_bytes = tet_bytes(mesh);
  return measured(cost, [&] { return sound::bake(mesh, ceramic(), bake_options()); });
}

}  // namespace

std::optional<ModalCost> analyse_spring_shell() {
  return in_child([] {
    const TriangleMesh mesh = sheet(13, [](int, int) { return 0.0; });
    ModalCost cost;
    cost.vertices = double(mesh.positions.size());
    cost.elements = double(mesh.triangles.size());
    cost.unknowns = 3 * cost.vertices;
    cost.mesh_bytes = surface_bytes(mesh.positions.size(), mesh.triangles.size());
    return measured(cost, [&]() -> Result<sound::ModalModel> {
      const auto body = sound::body_surface(mesh, "sheet", tile_thickness);
      if (!body) return tl::unexpected(body.error());
      return sound::bake_spring_shell(*body, tile_thickness, ceramic(), bake_options(), "sheet");
    });
  });
}

std::optional<ModalCost> analyse_slab() {
  return in_child([] {
    const Vec3 size(tile_side, tile_thickness, tile_side);
    const double area = 2 * tile_side * tile_side + 4 * tile_side * tile_thickness;
    const double element = sound::element_size(size.prod(), area, ceramic(), bake_options().modes);
    const sound::SolidShape slab{sound::SolidShape::Kind::box, size};
    return bake_elements(slab.mesh(element, 40'000));
  });
}

std::optional<ModalCost> analyse_mesh(int texels) {
  return in_child([&] { return bake_mesh(tile(texels)); });
}

std::optional<ModalCost> analyse_every_vertex(int cells) {
  return in_child([&] {
    return bake_elements(sound::box({tile_side, tile_thickness, tile_side}, cells, 1, cells));
  });
}

#ifdef INTAGLIO_HAS_LAPACK

bool has_dense_method() {
  return true;
}

namespace {

struct DenseModes {
  Eigen::VectorXd values;
  double bytes = 0, seconds = 0;
};

DenseModes dense_modes(const sound::ElasticSystem& system) {
  const PeakMemory peak;
  const double start = cpu_seconds();
  const int n = int(system.dofs());
  Eigen::MatrixXd stiffness(system.stiffness), mass = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < system.mass.outerSize(); ++k) {
    for (sound::SparseMatrix::InnerIterator entry(system.mass, k); entry; ++entry) {
      for (int axis = 0; axis < 3; ++axis)
        mass(3 * entry.row() + axis, 3 * entry.col() + axis) = entry.value();
    }
  }
  DenseModes out;
  out.values.resize(n);
  const int type = 1, work_size = 1 + 6 * n + 2 * n * n, whole_size = 3 + 5 * n;
  std::vector<double> work(std::size_t(work_size), 0.0);
  std::vector<int> whole(std::size_t(whole_size), 0);
  int info = 0;
  dsygvd_(&type, "V", "L", &n, stiffness.data(), &n, mass.data(), &n, out.values.data(), work.data(),
          &work_size, whole.data(), &whole_size, &info);
  out.seconds = cpu_seconds() - start;
  out.bytes = peak.bytes();
  if (info != 0) _exit(1);
  return out;
}

}  // namespace

std::optional<DenseCost> compare_dense(int cells) {
  return in_child([&] {
    const sound::SingleThreadedBlas single;
    const sound::ElasticSystem system =
        sound::assemble(sound::box({tile_side, tile_thickness, tile_side}, cells, 1, cells), ceramic());
    DenseCost cost;
    cost.unknowns = double(system.dofs());
    sound::Modes ours;
    {
      const PeakMemory peak;
      const double start = cpu_seconds();
      auto found = sound::free_modes(system, {.count = modes, .max_frequency = 100'000});
      if (!found) _exit(1);
      ours = std::move(*found);
      cost.our_seconds = cpu_seconds() - start;
      cost.our_bytes = peak.bytes();
    }
    const DenseModes dense = dense_modes(system);
    cost.dense_seconds = dense.seconds;
    cost.dense_bytes = dense.bytes;
    for (Eigen::Index k = 0; k < modes; ++k) {
      const double reference = std::sqrt(dense.values[6 + k]);  // six rigid motions come first
      cost.difference = std::max(cost.difference, std::abs(ours.angular_frequency[k] / reference - 1));
    }
    return cost;
  });
}

#else

bool has_dense_method() {
  return false;
}

std::optional<DenseCost> compare_dense(int) {
  return std::nullopt;
}

#endif

}  // namespace intaglio::bench
