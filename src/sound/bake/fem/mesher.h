// How a surface becomes tetrahedra: by the lattice (fill_surface.h), or by Netgen in a child process.
#pragma once

#include <filesystem>

#include "sound/bake/fem/fill_surface.h"

namespace intaglio::sound {

// A clean closed surface filled by Netgen: sharp edges are kept in any direction, where the lattice cuts them
// off by a fraction of an element.
//
// Netgen throws, hangs and crashes on surfaces that are not clean, prints freely and keeps global state; so
// the program `intaglio-netgen` (apps/netgen/, built if Debian's libnglib-dev is installed) runs it, with
// limits of time and memory, in a temporary folder, and its result is checked: every tetrahedron has volume,
// together they have the body's, and their outside is closed. Every failure is reported as an error. Blocks;
// any thread. Cost: about 0.2 ms per element. Source: Schoeberl, "NETGEN: an advancing front 2D/3D-mesh
// generator based on abstract rules", 1997.

struct NetgenOptions {
  std::filesystem::path program;  // empty: find_netgen()
  double seconds = 60;            // time limit
  double memory_mb = 4000;        // of address space
};

// The program: what the environment's INTAGLIO_NETGEN names, or intaglio-netgen beside this program or in the
// folder above; empty if there is none.
std::filesystem::path find_netgen();

// Fails on surfaces that are open, shells with a thickness among them, and as above. `name` appears in
// errors.
Result<FilledSurface> netgen_fill(const BodySurface& body, const FillOptions& options,
                                  const NetgenOptions& netgen, const std::string& name);

// Chooses a mesher: the lattice for bodies that are round, aligned with their own flat faces or not clean;
// Netgen where sharp edges run across the lattice, which cuts them off (docs/bake.md has the figures).

enum class Mesher { automatic, lattice, netgen };

// Whether the surface has sharp edges (more than 30 degrees) that the lattice does not follow: at least one
// adjoining face is more than 10 degrees off the lattice's axes. Edges that are closer together than an
// element, such as a relief's, are ignored.
bool has_skew_edges(const BodySurface& body, double element_size);
// Element-size factor for such bodies, whose elements are less well shaped near the edges.
inline constexpr double skew_edge_size_factor = 0.7;

// Fills with the given mesher. Automatic: Netgen for a closed surface of one shell with skew edges and at
// most 20,000 triangles, within 20 s; if it is not installed, or fails, the lattice, with a note that says
// so.
Result<FilledSurface> fill_with(Mesher mesher, const BodySurface& body, const FillOptions& options,
                                const NetgenOptions& netgen, const std::string& name);

}  // namespace intaglio::sound
