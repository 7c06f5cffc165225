// A clean closed surface filled by Netgen, in a process of its own: sharp edges are kept in any direction,
// where the lattice (fill_surface.h) cuts them off by a fraction of an element.
//
// Netgen throws, hangs and crashes on surfaces that are not clean, prints as it likes and keeps global state;
// so the program `intaglio-netgen` (app/netgen/, built where Debian's libnglib-dev is installed) runs it,
// with limits of time and memory, in a folder of its own, and what it returns is checked: every tetrahedron
// has volume, together they have the body's, and their outside is closed. Whatever goes wrong is one error.
// Blocks; any thread. Cost: about 0.2 ms an element. Source: Schoeberl, "NETGEN: an advancing front
// 2D/3D-mesh generator based on abstract rules", 1997.
#pragma once

#include <filesystem>

#include "sound/bake/fem/fill_surface.h"

namespace intaglio::sound {

struct NetgenOptions {
  std::filesystem::path program;  // empty: find_netgen()
  double seconds = 60;            // then it is ended
  double memory_mb = 4000;        // of address space
};

// The program: what the environment's INTAGLIO_NETGEN names, or intaglio-netgen beside this program or in the
// folder above; empty when there is none.
std::filesystem::path find_netgen();

// Fails on surfaces that are open, shells with a thickness among them, and as above. `name` is for errors.
Result<FilledSurface> netgen_fill(const BodySurface& body, const FillOptions& options,
                                  const NetgenOptions& netgen, const std::string& name);

// Which mesher fills a body best: the lattice for whatever is round, lies along its own flat faces or is not
// clean; Netgen where sharp edges run across the lattice, which cuts them off (docs/bake.md has the figures).

enum class Mesher { automatic, lattice, netgen };

// Whether the surface has edges of more than 30 degrees between faces of which one is more than 25 degrees
// off the lattice, and these lie farther apart than an element: finer ones, a relief's, no mesher should
// follow.
bool has_skew_edges(const BodySurface& body, double element_size);
// Times the size that waves need: elements about such edges are not as well shaped as others.
inline constexpr double at_skew_edges = 0.7;

// By the mesher that is asked for. Automatic: Netgen for a closed surface of one shell with skew edges and at
// most 20,000 triangles, within 20 s; where it is not installed, or fails, the lattice, with a note that says
// so.
Result<FilledSurface> fill_by(Mesher mesher, const BodySurface& body, const FillOptions& options,
                              const NetgenOptions& netgen, const std::string& name);

}  // namespace intaglio::sound
