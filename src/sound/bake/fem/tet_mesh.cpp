#include "sound/bake/fem/tet_mesh.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <unordered_map>
#include <vector>
#include <fmt/format.h>

#include "sound/bake/fem/elastic_system.h"

namespace intaglio::sound {

namespace {

// Makes each mid-edge node once, however many tetrahedra share the edge.
class MidEdgeNodes {
 public:
  explicit MidEdgeNodes(std::vector<Vec3>& nodes) : nodes_(nodes) {}

  int between(int a, int b) {
    const std::uint64_t key =
        static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint64_t>(std::max(a, b));
    const auto [found, is_new] = made_.try_emplace(key, static_cast<int>(nodes_.size()));
    if (is_new) {
      const Vec3 middle = 0.5 * (nodes_[std::size_t(a)] + nodes_[std::size_t(b)]);
      nodes_.push_back(middle);
    }
    return found->second;
  }

 private:
  std::vector<Vec3>& nodes_;
  std::unordered_map<std::uint64_t, int> made_;
};

bool is_positive(const std::vector<Vec3>& nodes, const std::array<int, 4>& tet) {
  const Vec3& origin = nodes[std::size_t(tet[0])];
  const auto edge = [&](std::size_t corner) -> Vec3 { return nodes[std::size_t(tet[corner])] - origin; };
  return edge(1).cross(edge(2)).dot(edge(3)) > 0;
}

std::vector<Triangle6> boundary_of(const std::vector<Tet10>& tets, MidEdgeNodes& mid_edge) {
  std::map<std::array<int, 3>, std::pair<int, std::array<int, 3>>>
      faces;  // sorted corners -> uses, outward corners
  for (const Tet10& tet : tets) {
    for (const auto& face : tet_faces) {
      const std::array<int, 3> outward{tet[std::size_t(face[0])], tet[std::size_t(face[1])],
                                       tet[std::size_t(face[2])]};
      auto key = outward;
      std::sort(key.begin(), key.end());
      auto& [uses, corners] = faces[key];
      ++uses;
      corners = outward;
    }
  }
  std::vector<Triangle6> boundary;
  for (const auto& [key, entry] : faces) {
    const auto& [uses, c] = entry;
    if (uses == 1) {
      boundary.push_back({c[0], c[1], c[2], mid_edge.between(c[0], c[1]), mid_edge.between(c[1], c[2]),
                          mid_edge.between(c[2], c[0])});
    }
  }
  return boundary;
}

}  // namespace

TetMesh quadratic_mesh(std::vector<Vec3> corners, std::vector<std::array<int, 4>> tets) {
  TetMesh mesh;
  mesh.nodes = std::move(corners);
  MidEdgeNodes mid_edge(mesh.nodes);
  for (auto& tet : tets) {
    if (!is_positive(mesh.nodes, tet)) std::swap(tet[2], tet[3]);
    Tet10 nodes{tet[0], tet[1], tet[2], tet[3]};
    for (std::size_t e = 0; e < tet_edges.size(); ++e) {
      nodes[4 + e] = mid_edge.between(tet[std::size_t(tet_edges[e][0])], tet[std::size_t(tet_edges[e][1])]);
    }
    mesh.tets.push_back(nodes);
  }
  mesh.boundary = boundary_of(mesh.tets, mid_edge);
  return mesh;
}

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet10& tet : mesh.tets) sum += element_volume(element_nodes(mesh, tet));
  return sum;
}

std::array<std::array<int, 4>, 3> prism_tets(std::array<int, 6> p) {
  // Turn the prism until its smallest index is corner 0: about its axis, or upside down first.
  const auto smallest = static_cast<std::size_t>(std::min_element(p.begin(), p.end()) - p.begin());
  if (smallest >= 3) p = {p[3], p[5], p[4], p[0], p[2], p[1]};
  while (p[0] != *std::min_element(p.begin(), p.end())) p = {p[1], p[2], p[0], p[4], p[5], p[3]};
  if (std::min(p[1], p[5]) < std::min(p[2], p[4])) {
    return {{{p[0], p[1], p[2], p[5]}, {p[0], p[1], p[5], p[4]}, {p[0], p[4], p[5], p[3]}}};
  }
  return {{{p[0], p[1], p[2], p[4]}, {p[0], p[4], p[2], p[5]}, {p[0], p[4], p[5], p[3]}}};
}

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

namespace {

constexpr double smallest = 1e-4, largest = 100;  // metres

struct Named {
  const char* name;
  SolidShape::Kind kind;
  std::vector<char> keys;
  const char* example;
};

const std::array<Named, 4>& known_shapes() {
  static const std::array<Named, 4> all{
      {{"sphere", SolidShape::Kind::sphere, {'r'}, "sphere:r=0.05"},
       {"box", SolidShape::Kind::box, {'x', 'y', 'z'}, "box:x=0.3,y=0.01,z=0.2"},
       {"plate", SolidShape::Kind::box, {'a', 't'}, "plate:a=0.3,t=0.01"},
       {"cylinder", SolidShape::Kind::cylinder, {'r', 'h'}, "cylinder:r=0.02,h=0.2"}}};
  return all;
}

const Named* find(const std::string& text) {
  const std::string name = text.substr(0, text.find(':'));
  for (const Named& shape : known_shapes()) {
    if (text.find(':') != std::string::npos && name == shape.name) return &shape;
  }
  return nullptr;
}

Vec3 size_of(const Named& shape, const std::vector<double>& v) {
  switch (shape.kind) {
    case SolidShape::Kind::sphere:
      return Vec3::Constant(2 * v[0]);
    case SolidShape::Kind::cylinder:
      return {2 * v[0], v[1], 2 * v[0]};
    default:
      return v.size() == 2 ? Vec3(v[0], v[1], v[0]) : Vec3(v[0], v[1], v[2]);
  }
}

}  // namespace

bool is_solid_shape(const std::string& text) {
  return find(text) != nullptr;
}

Result<SolidShape> solid_shape(const std::string& text) {
  const Named* const shape = find(text);
  if (!shape)
    return fail(text, "is no built-in shape", "sphere, box, plate or cylinder, as in sphere:r=0.05");
  const std::string fix =
      fmt::format("write it like {}, sizes between {} and {} m", shape->example, smallest, largest);
  std::vector<double> values(shape->keys.size(), 0);
  std::string_view rest = std::string_view(text).substr(text.find(':') + 1);
  while (!rest.empty()) {
    const std::string_view part = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    const auto key =
        part.empty() ? shape->keys.end() : std::find(shape->keys.begin(), shape->keys.end(), part[0]);
    if (key == shape->keys.end() || part.size() < 3 || part[1] != '=')
      return fail(text, fmt::format("\"{}\" is not understood", part), fix);
    double& value = values[std::size_t(key - shape->keys.begin())];
    if (value != 0) return fail(text, fmt::format("{} is given twice", *key), fix);
    const auto [end, error] = std::from_chars(part.data() + 2, part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || !(value >= smallest && value <= largest))
      return fail(text, fmt::format("\"{}\" is no size", part), fix);
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] == 0) return fail(text, fmt::format("{} is missing", shape->keys[k]), fix);
  }
  return SolidShape{shape->kind, size_of(*shape, values)};
}

double SolidShape::volume() const {
  const double full = size.prod();
  if (kind == Kind::sphere) return std::numbers::pi / 6 * full;
  return kind == Kind::cylinder ? std::numbers::pi / 4 * full : full;
}

double SolidShape::area() const {
  constexpr double pi = std::numbers::pi;
  if (kind == Kind::sphere) return pi * size.x() * size.x();
  if (kind == Kind::cylinder) return pi * size.x() * size.y() + 0.5 * pi * size.x() * size.x();
  return 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
}

TetMesh SolidShape::mesh(double element_size, int max_elements) const {
  for (double h = element_size;; h *= 1.1) {
    const auto count = [&](double extent, int least) {
      return std::max(least, int(std::ceil(std::min(extent / h, 1e6))));
    };
    if (kind == Kind::sphere) {
      const int level = std::clamp(int(std::ceil(std::log2(0.5 * size.x() / h))), 1, 8);
      if (level == 1 || 20 * std::pow(8, level) <= max_elements) return ball(0.5 * size.x(), level);
    } else if (kind == Kind::cylinder) {
      const int rings = count(0.5 * size.x(), 2), layers = count(size.y(), 1);
      if (h > size.maxCoeff() || 18.0 * rings * rings * layers <= max_elements)
        return cylinder(0.5 * size.x(), size.y(), rings, layers);
    } else {
      // One layer of quadratic elements bends well if they are no wider than it is thick.
      const auto even = [&](double extent) {
        return extent >= h && extent < 1.5 * h ? 1 : (count(extent, 2) + 1) / 2 * 2;
      };
      const int nx = even(size.x()), ny = even(size.y()), nz = even(size.z());
      if (h > size.maxCoeff() || 6.0 * nx * ny * nz <= max_elements) return box(size, nx, ny, nz);
    }
  }
}

}  // namespace intaglio::sound
