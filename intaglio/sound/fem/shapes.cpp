#include "intaglio/sound/fem/shapes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>

#include "intaglio/sound/fem/prism.h"

namespace intaglio::sound {

namespace {

constexpr std::array<std::array<int, 3>, 20> icosahedron_faces{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

std::vector<Vec3> icosahedron_corners() {
  constexpr double g = std::numbers::phi;
  std::vector<Vec3> corners{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                            {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& corner : corners) corner.normalize();
  return corners;
}

// Cuts every tetrahedron into eight: one at each corner, and the octahedron between them along its shortest
// diagonal.
CornerMesh refined(const CornerMesh& coarse) {
  CornerMesh fine{coarse.points, {}};
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(fine.points.size()));
    if (is_new)
      fine.points.emplace_back(0.5 * (coarse.points[std::size_t(a)] + coarse.points[std::size_t(b)]));
    return found->second;
  };
  const auto distance = [&](int a, int b) {
    return (fine.points[std::size_t(a)] - fine.points[std::size_t(b)]).norm();
  };
  for (const auto& [a, b, c, d] : coarse.tets) {
    const int ab = middle(a, b), ac = middle(a, c), ad = middle(a, d), bc = middle(b, c), bd = middle(b, d),
              cd = middle(c, d);
    fine.tets.insert(fine.tets.end(), {{a, ab, ac, ad}, {b, ab, bc, bd}, {c, ac, bc, cd}, {d, ad, bd, cd}});
    // A diagonal joins the middles of opposite edges; the other four middles go round it.
    struct Diagonal {
      int from, to;
      std::array<int, 4> ring;
    };
    const std::array<Diagonal, 3> diagonals{
        {{ab, cd, {ac, bc, bd, ad}}, {ac, bd, {ab, bc, cd, ad}}, {ad, bc, {ab, bd, cd, ac}}}};
    // The margin keeps the choice among equals independent of rounding.
    const Diagonal* best = &diagonals[0];
    for (const Diagonal& other : diagonals) {
      if (distance(other.from, other.to) < (1 - 1e-9) * distance(best->from, best->to)) best = &other;
    }
    for (std::size_t i = 0; i < 4; ++i)
      fine.tets.push_back({best->from, best->to, best->ring[i], best->ring[(i + 1) % 4]});
  }
  return fine;
}

struct Disk {
  std::vector<Vec2> points;
  std::vector<std::array<int, 3>> triangles;
};

// The unit hexagon in `rings` rings of equilateral triangles.
Disk hexagon(int rings) {
  Disk disk;
  std::map<std::pair<int, int>, int> index;  // lattice coordinates along 0 and 60 degrees
  for (int i = -rings; i <= rings; ++i) {
    for (int j = std::max(-rings, -rings - i); j <= std::min(rings, rings - i); ++j) {
      index[{i, j}] = static_cast<int>(disk.points.size());
      disk.points.emplace_back((i + 0.5 * j) / rings, 0.5 * std::numbers::sqrt3 * j / rings);
    }
  }
  const auto add = [&](std::pair<int, int> a, std::pair<int, int> b, std::pair<int, int> c) {
    if (index.contains(a) && index.contains(b) && index.contains(c))
      disk.triangles.push_back({index[a], index[b], index[c]});
  };
  for (int i = -rings; i <= rings; ++i) {
    for (int j = -rings; j <= rings; ++j) {
      add({i, j}, {i + 1, j}, {i, j + 1});
      add({i + 1, j}, {i + 1, j + 1}, {i, j + 1});
    }
  }
  return disk;
}

// The factor that carries (x, z) of the unit hexagon radially onto the unit disk, ring by ring.
double hexagon_to_disk(double x, double z) {
  const double radius = std::hypot(x, z);
  if (radius == 0) return 1;
  const double third = 0.5 * std::numbers::sqrt3;
  const double gauge =
      std::max({std::abs(z), std::abs(third * x + 0.5 * z), std::abs(third * x - 0.5 * z)}) / third;
  return gauge / radius;
}

}  // namespace

TetMesh ball(double radius, int level) {
  assert(radius > 0 && level >= 0);
  const std::vector<Vec3> corners = icosahedron_corners();
  CornerMesh icosahedron{corners, {}};
  const int centre = static_cast<int>(corners.size());
  icosahedron.points.emplace_back(Vec3::Zero());
  std::vector<Vec3> face_normals;  // scaled: 1 on the face
  for (const auto& [a, b, c] : icosahedron_faces) {
    icosahedron.tets.push_back({centre, a, b, c});
    const Vec3 middle = (corners[std::size_t(a)] + corners[std::size_t(b)] + corners[std::size_t(c)]) / 3;
    face_normals.emplace_back(middle / middle.squaredNorm());
  }
  for (int i = 0; i < level; ++i) icosahedron = refined(icosahedron);
  TetMesh mesh = quadratic_mesh(std::move(icosahedron.points), std::move(icosahedron.tets));
  for (Vec3& node : mesh.nodes) {
    double gauge = 0;  // 0 at the centre, 1 on the icosahedron
    for (const Vec3& normal : face_normals) gauge = std::max(gauge, normal.dot(node));
    if (gauge > 0) node = radius * gauge * node.normalized();
  }
  return mesh;
}

TetMesh box(const Vec3& size, int nx, int ny, int nz) {
  assert(size.minCoeff() > 0 && nx >= 1 && ny >= 1 && nz >= 1);
  const auto index = [&](int i, int j, int k) { return (k * (ny + 1) + j) * (nx + 1) + i; };
  CornerMesh mesh;
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        const Vec3 fraction(double(i) / nx - 0.5, double(j) / ny - 0.5, double(k) / nz - 0.5);
        mesh.points.emplace_back(size.cwiseProduct(fraction));
      }
    }
  }
  // Kuhn: one tetrahedron for each order in which a walk from corner 000 to 111 may take the three axes.
  constexpr std::array<std::array<int, 3>, 6> walks{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int cell = 0; cell < nx * ny * nz; ++cell) {
    const std::array<int, 3> place{cell % nx, cell / nx % ny, cell / (nx * ny)};
    for (const auto& walk : walks) {
      // Every other brick is the mirror image of its neighbour: it is walked the other way.
      std::array<int, 3> at, way;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool is_mirrored = place[axis] % 2 == 1;
        at[axis] = place[axis] + is_mirrored;
        way[axis] = is_mirrored ? -1 : 1;
      }
      std::array<int, 4> tet{index(at[0], at[1], at[2])};
      for (std::size_t step = 0; step < 3; ++step) {
        at[std::size_t(walk[step])] += way[std::size_t(walk[step])];
        tet[step + 1] = index(at[0], at[1], at[2]);
      }
      mesh.tets.push_back(tet);
    }
  }
  return quadratic_mesh(std::move(mesh.points), std::move(mesh.tets));
}

TetMesh cylinder(double radius, double length, int rings, int layers) {
  assert(radius > 0 && length > 0 && rings >= 1 && layers >= 1);
  const Disk disk = hexagon(rings);
  const int stride = static_cast<int>(disk.points.size());
  CornerMesh mesh;
  for (int layer = 0; layer <= layers; ++layer) {
    for (const Vec2& p : disk.points) mesh.points.emplace_back(p.x(), double(layer) / layers - 0.5, p.y());
  }
  for (int layer = 0; layer < layers; ++layer) {
    const int low = layer * stride, high = low + stride;
    for (const auto& [a, b, c] : disk.triangles) {
      for (const auto& tet : prism_tets({low + a, low + b, low + c, high + a, high + b, high + c}))
        mesh.tets.push_back(tet);
    }
  }
  TetMesh result = quadratic_mesh(std::move(mesh.points), std::move(mesh.tets));
  for (Vec3& node : result.nodes) {
    const double scale = radius * hexagon_to_disk(node.x(), node.z());
    node = Vec3(scale * node.x(), length * node.y(), scale * node.z());
  }
  return result;
}

}  // namespace intaglio::sound
