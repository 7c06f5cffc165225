#include "sound/bake/fem/fill_surface.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "sound/bake/fem/body_surface.h"
#include "sound/bake/fem/elastic_system.h"
#include "sound/bake/fem/inside.h"
#include "sound/bake/fem/lattice.h"
#include "sound/bake/fem/sharp_edges.h"

namespace intaglio::sound {

namespace {

constexpr double tets_per_cell = 12;
constexpr double max_lattice_points = 2e6;
constexpr double loose_share = 0.01;    // of the volume: smaller parts are lattice debris
constexpr double max_lid_share = 0.15;  // of the boundary that may have no surface nearby
constexpr double lid_distance = 0.3;    // in cells, beyond which a face counts as lid
constexpr double thin_extent = 2.2;     // in thicknesses: a square bar is twice as wide as 2 V / A
constexpr double flattest_cell = 2;     // its length, in thicknesses
constexpr double max_rescaling = 0.05;
constexpr double min_jacobian = 0.1;  // of the mean over the element

// Parts whose tetrahedra are connected by whole faces: the part of each tetrahedron.
std::vector<std::size_t> connected_parts(const CornerMesh& mesh) {
  DisjointSets sets(mesh.tets.size());
  std::map<std::array<int, 3>, std::size_t> faces;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t leave = 0; leave < 4; ++leave) {
      std::array<int, 3> face{};
      for (std::size_t k = 0; k < 3; ++k) face[k] = mesh.tets[t][(leave + 1 + k) % 4];
      std::sort(face.begin(), face.end());
      const auto [found, is_new] = faces.try_emplace(face, t);
      if (!is_new) sets.join(t, found->second);
    }
  }
  std::vector<std::size_t> part;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) part.push_back(sets.root(t));
  return part;
}

// Keeps the largest part, drops fragments, fails on a second large part.
Result<void> keep_largest(CornerMesh& mesh, std::vector<std::string>& notes, const std::string& name) {
  const std::vector<std::size_t> part = connected_parts(mesh);
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
                fmt::format("has {} disconnected parts; the largest is {:.0f} % of the volume", loose,
                            100 * largest.second / total),
                "bake each part on its own, or let them overlap; a link thinner than an element needs more "
                "elements");
  CornerMesh kept;
  Renumbering number(mesh.points.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (part[t] != largest.first) continue;
    kept.tets.push_back(mesh.tets[t]);
    for (int& v : kept.tets.back())
      v = number(v, [&](std::size_t point) { kept.points.push_back(mesh.points[point]); });
  }
  notes.push_back(fmt::format("{} small fragments, {:.2g} % of the volume, were dropped", volumes.size() - 1,
                              100 * (1 - largest.second / total)));
  mesh = std::move(kept);
  return {};
}

// Share of the boundary without surface nearby: what an open surface was closed by.
double lid_fraction(const TetMesh& mesh, const SurfaceQuery& surface, double near) {
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

// `to_frame` rotates the body into the lattice's axes.
Result<LatticeBox> choose_lattice(const BodySurface& body, const Mat3& to_frame, const FillOptions& options,
                                  const std::string& name) {
  Eigen::AlignedBox3d bounds;
  for (const Triangle& t : body.triangles) {
    const Vec3 cross = triangle_cross(body.points, t);
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
  // A plate or bar along the axes may have flat cells: waves run along it, not through it.
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

// Decides how inside and outside are distinguished.
enum class SurfaceKind { shell, closed, open };

SurfaceKind kind_of(const BodySurface& body) {
  if (body.thickness > 0) return SurfaceKind::shell;
  return body.is_closed() ? SurfaceKind::closed : SurfaceKind::open;
}

// The solid that a lattice in the axes of `frame` fills. All arguments must outlive it.
SolidQuery solid_query(const BodySurface& body, const SurfaceQuery& surface, const WindingNumber& winding,
                       const std::optional<ThickShell>& shell, const Mat3& frame) {
  switch (kind_of(body)) {
    case SurfaceKind::shell:
      return {[&](const Vec3& p) { return shell->contains(frame * p); },
              [&](const Vec3& p, double reach) {
                return surface.distance(frame * p, reach) - 0.5 * body.thickness;
              }};
    case SurfaceKind::closed:  // only then does the winding number change only at the surface
      return {
          [&](const Vec3& p) { return winding.value(frame * p) > 0.5; },
          [&](const Vec3& p, double reach) { return surface.distance(frame * p, reach); },
          [&](const Vec3& in, const Vec3& out) { return surface.single_crossing(frame * in, frame * out); }};
    case SurfaceKind::open:
      break;
  }
  return {[&](const Vec3& p) { return winding.value(frame * p) > 0.5; }};
}

// Edges that are closer together than elements, such as a relief's, are not restored; nor are those inside
// other shells, which have matter on both sides.
void restore_edges(CornerMesh& corners, const BodySurface& body, const SurfaceQuery& surface,
                   const WindingNumber& winding, double cell) {
  std::vector<SharpEdge> sharp = find_sharp_edges(body);
  std::erase_if(sharp, [&](const SharpEdge& e) {
    const Vec3 middle = 0.5 * (body.points[std::size_t(e.from)] + body.points[std::size_t(e.to)]);
    return winding.value(middle + 1e-3 * cell * (e.left + e.right).normalized()) > 0.5;
  });
  if (!sharp.empty() && total_length(sharp, body) * cell < body.area)
    keep_edges(corners, SharpEdges(body, sharp, cell), surface, cell);
}

// The error for a body of several large parts, whose first cause depends on its kind.
Error explain_parts(const Error& error, const BodySurface& body, double cell, const std::string& name) {
  switch (kind_of(body)) {
    case SurfaceKind::shell:
      return {name,
              fmt::format("falls apart: elements of {:.2g} m are too large for a curved shell of {:.2g} m",
                          cell, body.thickness),
              fmt::format("use --element-size {:.2g}", 0.5 * body.thickness)};
    case SurfaceKind::open:
      return {name, "is open and encloses no volume of one piece", "close the surface, or set a thickness"};
    case SurfaceKind::closed:
      break;
  }
  return error;
}

bool is_well_shaped(const TetMesh& mesh, const Tet10& tet) {
  const ElementNodes nodes = element_nodes(mesh, tet);
  const double least = min_jacobian * 6 * element_volume(nodes);
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

// Moves the mid-edge nodes of the boundary onto the surface; nodes of invalid elements are reset.
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
  for (bool was_reset = true; was_reset;) {
    was_reset = false;
    for (const Tet10& tet : mesh.tets) {
      if (is_well_shaped(mesh, tet)) continue;
      for (std::size_t k = 4; k < 10; ++k) {
        const auto found = straight.find(tet[k]);
        if (found == straight.end()) continue;
        mesh.nodes[std::size_t(tet[k])] = found->second;
        straight.erase(found);
        was_reset = true;
      }
    }
  }
}

void restore_volume(TetMesh& mesh, const BodySurface& body, std::vector<std::string>& notes) {
  const double ratio = body.volume / volume(mesh);
  if (std::abs(ratio - 1) > max_rescaling) {
    notes.push_back(fmt::format(
        "the surface's volume is {:.3g} times that of the mesh: it overlaps itself or has details finer "
        "than an element",
        ratio));
    return;
  }
  const Vec3 middle = 0.5 * (body.low + body.high);
  const double scale = std::cbrt(ratio);
  for (Vec3& node : mesh.nodes) node = middle + scale * (node - middle);
}

}  // namespace

Result<FilledSurface> fill_surface(const BodySurface& body, const FillOptions& options,
                                   const std::string& name) {
  const Mat3 frame = flat_frame(body.points, body.triangles);
  const auto box = choose_lattice(body, frame.transpose(), options, name);
  if (!box) return tl::unexpected(box.error());
  const auto surface = SurfaceQuery::make(body, name);
  if (!surface) return tl::unexpected(surface.error());
  const SurfaceKind kind = kind_of(body);
  const WindingNumber winding(body.points, body.triangles);
  std::optional<ThickShell> shell;
  if (kind == SurfaceKind::shell) shell.emplace(body, *surface);

  CornerMesh corners = fill_lattice(*box, solid_query(body, *surface, winding, shell, frame));
  for (Vec3& p : corners.points) p = frame * p;
  if (corners.tets.empty()) return fail(name, "encloses no volume", "close the surface, or set a thickness");
  FilledSurface filled{{}, std::cbrt(box->cell.prod()), body.notes};
  if (auto kept = keep_largest(corners, filled.notes, name); !kept)
    return tl::unexpected(explain_parts(kept.error(), body, filled.element_size, name));
  if (kind == SurfaceKind::closed) restore_edges(corners, body, *surface, winding, filled.element_size);
  filled.mesh = quadratic_mesh(std::move(corners.points), std::move(corners.tets));

  // The surface given is the middle of a shell: there is none to fit to.
  if (kind == SurfaceKind::shell) return filled;
  if (kind == SurfaceKind::open) {
    const double lid = lid_fraction(filled.mesh, *surface, lid_distance * filled.element_size);
    if (lid > max_lid_share)
      return fail(
          name,
          fmt::format("is open: {:.0f} % of the solid's surface would be invented to close it", 100 * lid),
          "close the surface, or set the shell's thickness");
  }
  fit_surface(filled.mesh, body, *surface, filled.notes);
  return filled;
}

void fit_surface(TetMesh& mesh, const BodySurface& body, const SurfaceQuery& surface,
                 std::vector<std::string>& notes) {
  curve(mesh, surface);
  if (body.is_closed()) restore_volume(mesh, body, notes);
}

}  // namespace intaglio::sound
