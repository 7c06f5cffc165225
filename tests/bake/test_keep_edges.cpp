// Laws of sharp edges that run across the lattice: elements stay valid, and frequencies are those of meshes
// made for the purpose.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <cmath>
#include <map>

#include "sound/bake/bake.h"
#include "sound/bake/fem/mesher.h"
#include "sound/bake/fem/tet_mesh.h"
#include "tests/bake/surfaces.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

// A ring between two polygons of as many corners, upright.
struct Ring {
  const char* name;
  int corners;
  double outer, inner, turn, height;  // radii to corners, m; the inner one is turned
  int along, across, layers;          // elements of the reference: of a side, and so on
  double worst;
};

Vec2 on_polygon(const Ring& ring, double radius, double turn, double at) {
  const auto corner = [&](double k) {
    return Vec2(radius * std::cos(turn + tau * k / ring.corners),
                radius * std::sin(turn + tau * k / ring.corners));
  };
  const double side = std::floor(at);
  return (1 - (at - side)) * corner(side) + (at - side) * corner(side + 1);
}

TetMesh elements_of(const Ring& ring, int along, int across, int layers) {
  CornerMesh mesh;
  const int around = ring.corners * along;
  for (int l = 0; l <= layers; ++l) {
    for (int r = 0; r <= across; ++r) {
      for (int k = 0; k < around; ++k) {
        const double share = double(r) / across, at = double(k) / along;
        const Vec2 p = (1 - share) * on_polygon(ring, ring.outer, 0, at) +
                       share * on_polygon(ring, ring.inner, ring.turn, at);
        mesh.points.emplace_back(p.x(), ring.height * l / layers, p.y());
      }
    }
  }
  const auto id = [&](int l, int r, int k) { return (l * (across + 1) + r) * around + k % around; };
  for (int l = 0; l < layers; ++l) {
    for (int r = 0; r < across; ++r) {
      for (int k = 0; k < around; ++k) {
        const int m = l + 1, s = r + 1, j = k + 1;
        for (const auto& prism :
             {std::array{id(l, r, k), id(l, r, j), id(l, s, j), id(m, r, k), id(m, r, j), id(m, s, j)},
              std::array{id(l, r, k), id(l, s, j), id(l, s, k), id(m, r, k), id(m, s, j), id(m, s, k)}}) {
          for (const auto& tet : prism_tets(prism)) mesh.tets.push_back(tet);
        }
      }
    }
  }
  return quadratic_mesh(std::move(mesh.points), std::move(mesh.tets));
}

BodySurface surface_of(const Ring& ring) {
  const TetMesh coarse = elements_of(ring, 1, 1, 1);
  std::vector<Vec3> points;
  std::vector<surface::Triangle> faces;
  for (const Triangle6& f : coarse.boundary) {
    for (std::size_t k = 0; k < 3; ++k) points.push_back(coarse.nodes[std::size_t(f[k])]);
    const int end = int(points.size());
    faces.push_back({end - 3, end - 2, end - 1});
  }
  return body_surface(test::mesh_of(points, faces), ring.name).value();
}

Eigen::ArrayXd hertz(const TetMesh& mesh, int count) {
  return free_modes(assemble(mesh, test::steel()), {count, 20, 20'000}).value().angular_frequency.array() /
         tau;
}

// Sides of the boundary without exactly one face on each side: a crack between elements opens some.
int open_sides(const TetMesh& mesh) {
  std::map<std::pair<int, int>, int> balance;
  for (const Triangle6& f : mesh.boundary) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = f[k], b = f[(k + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  int open = 0;
  for (const auto& side : balance) open += side.second != 0;
  return open;
}

}  // namespace

TEST_CASE("bodies whose sharp edges run across the lattice ring within some per cent by it alone" *
          doctest::test_suite("statistics")) {
  for (const Ring& ring : {Ring{"square frame", 4, 0.2, 0.12, -0.35, 0.04, 16, 6, 3, 0.022},
                           Ring{"ring of 64 sides", 64, 0.1, 0.07, 0, 0.03, 2, 4, 4, 0.005},
                           Ring{"pentagonal hole", 5, 0.1, 0.055, -0.377, 0.04, 12, 6, 4, 0.015},
                           Ring{"hexagonal hole", 6, 0.1, 0.05, -0.3, 0.08, 10, 6, 6, 0.015}}) {
    INFO(std::string(ring.name));
    const BodySurface body = surface_of(ring);
    CHECK(body.is_closed());
    const int count = 20;
    const double size = element_size(body.volume, body.area, test::steel(), {count, 20, 20'000});
    CHECK(has_skew_edges(body, size));
    const auto filled = fill_surface(body, {skew_edge_size_factor * size, 40'000}, ring.name);
    REQUIRE(filled);
    CHECK(filled->notes.empty());
    CHECK(open_sides(filled->mesh) == 0);
    CHECK(volume(filled->mesh) == doctest::Approx(body.volume).epsilon(1e-9));
    const Eigen::ArrayXd exact = hertz(elements_of(ring, ring.along, ring.across, ring.layers), count),
                         ours = hertz(filled->mesh, count);
    REQUIRE(exact.size() == ours.size());
    const Eigen::ArrayXd off = (ours / exact - 1).abs();
    MESSAGE(fmt::format("{}: {} elements, worst {:.2f} %, mean {:.2f} %", ring.name, filled->mesh.tets.size(),
                        100 * off.maxCoeff(), 100 * off.mean()));
    CHECK(off.maxCoeff() < ring.worst);
  }
}
