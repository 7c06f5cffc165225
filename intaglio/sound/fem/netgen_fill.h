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

#include "intaglio/sound/fem/fill_surface.h"

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

}  // namespace intaglio::sound
