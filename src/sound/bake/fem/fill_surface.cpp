#include "sound/bake/fem/fill_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <fmt/format.h>

#include "sound/bake/fem/body_surface.h"
#include "sound/bake/fem/elastic_system.h"
#include "sound/bake/fem/inside.h"
#include "sound/bake/fem/lattice.h"
#include "sound/bake/fem/sharp_edges.h"

namespace intaglio::sound {

namespace {

constexpr double tets_per_cell = 12;
constexpr double max_lattice_points = 2e6;
constexpr double loose_share = 0.01;  // of the volume: a smaller loose part is a crumb of the lattice
constexpr double lid_share = 0.15;  // of the boundary: where so much of it has no surface near, it is made up
constexpr double lid_distance = 0.3;  // of a cell: what is farther from the surface is not it
constexpr double thin_extent = 2.2;   // of the thickness: a square bar is twice as wide as 2 V / A
constexpr double flattest_cell = 2;   // of the thickness, its length

double signed_volume(const std::vector<Vec3>& points, const std::array<int, 4>& t) {
  const Vec3& o = points[std::size_t(t[0])];
  return (points[std::size_t(t[1])] - o)
             .cross(points[std::size_t(t[2])] - o)
             .dot(points[std::size_t(t[3])] - o) /
         6;
}

// Parts whose tetrahedra hang together by whole faces: the part of each tetrahedron.
std::vector<std::size_t> parts_of(const CornerMesh& mesh) {
  std::vector<std::size_t> parent(mesh.tets.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  std::map<std::array<int, 3>, std::size_t> faces;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t leave = 0; leave < 4; ++leave) {
      std::array<int, 3> face{};
      for (std::size_t k = 0; k < 3; ++k) face[k] = mesh.tets[t][(leave + 1 + k) % 4];
      std::sort(face.begin(), face.end());
      const auto [found, is_new] = faces.try_emplace(face, t);
      if (!is_new) parent[root(t)] = root(found->second);
    }
  }
  for (std::size_t t = 0; t < parent.size(); ++t) parent[t] = root(t);
  return parent;
}

// Leaves the largest part; crumbs go, a second real part is an error.
Result<void> keep_largest(CornerMesh& mesh, std::vector<std::string>& notes, const std::string& name) {
  const std::vector<std::size_t> part = parts_of(mesh);
  std::map<std::size_t, double> volumes;
  double total = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const double v = std::abs(signed_volume(mesh.points, mesh.tets[t]));
    volumes[part[t]] += v;
    total += v;
  }
  if (volumes.size() == 1) return {};
  const auto by_volume = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto largest = *std::max_element(volumes.begin(), volumes.end(), by_volume);
  const auto loose = std::count_if(volumes.begin(), volumes.end(),
                                   [&](const auto& v) { return v.second > loose_share * total; });
  if (loose > 1)
    return fail(name,
                fmt::format("falls into {} loose parts, the largest {:.0f} % of the volume", loose,
                            100 * largest.second / total),
                "bake each part on its own, or let them overlap; a link thinner than an element needs more "
                "elements");
  CornerMesh kept;
  std::vector<int> number(mesh.points.size(), -1);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (part[t] != largest.first) continue;
    kept.tets.push_back(mesh.tets[t]);
    for (int& v : kept.tets.back()) {
      int& n = number[std::size_t(v)];
      if (n < 0) {
        n = static_cast<int>(kept.points.size());
        kept.points.push_back(mesh.points[std::size_t(v)]);
      }
      v = n;
    }
  }
  notes.push_back(fmt::format("{} loose crumbs, {:.2g} % of the volume, were left out", volumes.size() - 1,
                              100 * (1 - largest.second / total)));
  mesh = std::move(kept);
  return {};
}

// How much of the boundary has no triangle of the surface near: what an open surface was closed by.
double share_of_lid(const TetMesh& mesh, const SurfaceQuery& surface, double near) {
  double lid = 0, area = 0;
  for (const Triangle6& f : mesh.boundary) {
    const Vec3 &a = mesh.nodes[std::size_t(f[0])], &b = mesh.nodes[std::size_t(f[1])],
               &c = mesh.nodes[std::size_t(f[2])];
    const double part = (b - a).cross(c - a).norm();
    if (!surface.nearest((a + b + c) / 3, near)) lid += part;
    area += part;
  }
  return lid / area;
}

// `to_frame` turns the body into the lattice's axes.
Result<LatticeBox> choose_lattice(const BodySurface& body, const Mat3& to_frame, const FillOptions& options,
                                  const std::string& name) {
  Eigen::AlignedBox3d bounds;
  for (const Triangle& t : body.triangles) {
    const Vec3& o = body.points[std::size_t(t[0])];
    const Vec3 cross = (body.points[std::size_t(t[1])] - o).cross(body.points[std::size_t(t[2])] - o);
    const Vec3 half = cross.norm() > 0 ? Vec3(0.5 * body.thickness * cross.normalized()) : Vec3(Vec3::Zero());
    for (const int p : t) {
      bounds.extend(to_frame * (body.points[std::size_t(p)] + half));
      bounds.extend(to_frame * (body.points[std::size_t(p)] - half));
    }
  }
  const double smallest = std::cbrt(body.volume * tets_per_cell / options.max_elements);
  const double size = std::max(options.element_size, smallest);
  // Twice volume over area is a plate's thickness and two thirds of a ball's radius.
  const double thickness = 2 * body.volume / body.area;
  // A plate or a bar that lies along the axes may have flat cells: waves run along it, not through it.
  Vec3 wanted = Vec3::Constant(std::min(size, thickness));
  const auto is_thin = (bounds.sizes().array() < thin_extent * thickness).eval();
  for (int axis = 0; axis < 3; ++axis) {
    if (is_thin.any() && !is_thin[axis]) wanted[axis] = std::min(size, flattest_cell * thickness);
  }
  const LatticeBox box(bounds.min(), bounds.max(), wanted);
  const double cell = std::cbrt(box.cell.prod());
  const double elements = body.volume * tets_per_cell / (cell * cell * cell);
  if (elements > 1.5 * options.max_elements || box.points() > max_lattice_points)
    return fail(
        name, fmt::format("is {:.2g} m thick, which needs about {:.0f} elements", thickness, elements),
        fmt::format("at most {} are allowed; use a built-in shape, or allow more", options.max_elements));
  return box;
}

}  // namespace

Result<FilledSurface> fill_surface(const surface::TriangleMesh& mesh, const FillOptions& options,
                                   const std::string& name) {
  const auto body = body_surface(mesh, name);
  if (!body) return tl::unexpected(body.error());
  return fill_surface(*body, options, name);
}

Result<FilledSurface> fill_surface(const BodySurface& body, const FillOptions& options,
                                   const std::string& name) {
  const Mat3 frame = flat_frame(body.points, body.triangles);
  const auto box = choose_lattice(body, frame.transpose(), options, name);
  if (!box) return tl::unexpected(box.error());
  const auto surface = SurfaceQuery::make(body, name);
  if (!surface) return tl::unexpected(surface.error());

  const WindingNumber winding(body.points, body.triangles);
  Solid solid{[&](const Vec3& p) { return winding.at(frame * p) > 0.5; }};
  std::optional<ThickShell> shell;
  if (body.thickness > 0) {
    shell.emplace(body, *surface);
    solid.inside = [&](const Vec3& p) { return shell->holds(frame * p); };
    solid.clearance = [&](const Vec3& p, double reach) {
      return surface->distance(frame * p, reach) - 0.5 * body.thickness;
    };
  } else if (body.is_closed()) {
    // Only then does the winding number change nowhere but at the surface.
    solid.clearance = [&](const Vec3& p, double reach) { return surface->distance(frame * p, reach); };
    solid.crossing = [&](const Vec3& in, const Vec3& out) {
      return surface->only_crossing(frame * in, frame * out);
    };
  }
  CornerMesh corners = fill(*box, solid);
  for (Vec3& p : corners.points) p = frame * p;
  if (corners.tets.empty())
    return fail(name, "encloses no volume", "close the surface, or give it thickness");
  FilledSurface filled{{}, std::cbrt(box->cell.prod()), body.notes};
  if (auto kept = keep_largest(corners, filled.notes, name); !kept) {
    if (body.thickness > 0)
      return fail(
          name,
          fmt::format("falls apart: elements of {:.2g} m are too large for a curved shell of {:.2g} m",
                      filled.element_size, body.thickness),
          fmt::format("use --element-size {:.2g}", 0.5 * body.thickness));
    if (body.is_closed()) return tl::unexpected(kept.error());
    return fail(name, "is open and encloses no volume of one piece",
                "close the surface, or give it thickness");
  }
  if (body.thickness == 0 && body.is_closed()) {
    // Finer ones than elements, a relief's, are not followed.
    std::vector<SharpEdge> sharp = sharp_edges_of(body);
    // Nor those that other shells enclose: on both sides of them is matter.
    std::erase_if(sharp, [&](const SharpEdge& e) {
      const Vec3 middle = 0.5 * (body.points[std::size_t(e.from)] + body.points[std::size_t(e.to)]);
      return winding.at(middle + 1e-3 * filled.element_size * (e.left + e.right).normalized()) > 0.5;
    });
    if (!sharp.empty() && length_of(sharp, body) * filled.element_size < body.area)
      keep_edges(corners, SharpEdges(body, sharp, filled.element_size), *surface, filled.element_size);
  }
  filled.mesh = quadratic_mesh(std::move(corners.points), std::move(corners.tets));

  // The surface given is the middle of a shell: there is none to curve onto or to be missed.
  if (body.thickness > 0) return filled;
  if (!body.is_closed()) {
    const double lid = share_of_lid(filled.mesh, *surface, lid_distance * filled.element_size);
    if (lid > lid_share)
      return fail(name, fmt::format("is open: {:.0f} % of the solid's surface would be made up", 100 * lid),
                  "close the surface, or give the shell thickness");
  }
  fit_surface(filled.mesh, body, *surface, filled.notes);
  return filled;
}

namespace {

constexpr double max_rescaling = 0.05;
constexpr double least_jacobian = 0.1;  // of the mean over the element

bool is_positive(const TetMesh& mesh, const Tet10& tet) {
  const ElementNodes nodes = element_nodes(mesh, tet);
  const double least = least_jacobian * 6 * element_volume(nodes);
  if (!(least > 0)) return false;
  for (const QuadraturePoint& q : tet_quadrature()) {
    if (!(jacobian(nodes, q.barycentric) > least)) return false;
  }
  for (std::size_t corner = 0; corner < 4; ++corner) {
    std::array<double, 4> at{};
    at[corner] = 1;
    if (!(jacobian(nodes, at) > least)) return false;
  }
  return true;
}

// Moves the mid-edge nodes of the boundary onto the surface; those of elements that suffer go back.
void curve(TetMesh& mesh, const SurfaceQuery& surface) {
  std::map<int, Vec3> straight;
  for (const Triangle6& f : mesh.boundary) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int middle = f[3 + k];
      Vec3& node = mesh.nodes[std::size_t(middle)];
      if (!straight.try_emplace(middle, node).second) continue;
      const double length = (mesh.nodes[std::size_t(f[k])] - mesh.nodes[std::size_t(f[(k + 1) % 3])]).norm();
      if (const auto nearest = surface.nearest(node, 0.25 * length)) node = *nearest;
    }
  }
  for (bool suffered = true; suffered;) {
    suffered = false;
    for (const Tet10& tet : mesh.tets) {
      if (is_positive(mesh, tet)) continue;
      for (std::size_t k = 4; k < 10; ++k) {
        const auto found = straight.find(tet[k]);
        if (found == straight.end()) continue;
        mesh.nodes[std::size_t(tet[k])] = found->second;
        straight.erase(found);
        suffered = true;
      }
    }
  }
}

void restore_volume(TetMesh& mesh, const BodySurface& body, std::vector<std::string>& notes) {
  const double ratio = body.volume / volume(mesh);
  if (std::abs(ratio - 1) > max_rescaling) {
    notes.push_back(
        fmt::format("the volume within the windings is {:.3g} times what was filled: it overlaps itself "
                    "or has parts finer than an element",
                    ratio));
    return;
  }
  const Vec3 middle = 0.5 * (body.low + body.high);
  const double scale = std::cbrt(ratio);
  for (Vec3& node : mesh.nodes) node = middle + scale * (node - middle);
}

}  // namespace

void fit_surface(TetMesh& mesh, const BodySurface& body, const SurfaceQuery& surface,
                 std::vector<std::string>& notes) {
  curve(mesh, surface);
  if (body.is_closed()) restore_volume(mesh, body, notes);
}

}  // namespace intaglio::sound
