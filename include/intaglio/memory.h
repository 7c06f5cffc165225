// How much memory a file may ask for. The needs of scenes, meshes and textures are estimated from their
// headers; a file that needs more than is allowed is an error that states the figure, before anything large
// is allocated (docs/trust.md, Budgets). The functions that read files take the limit; no file can raise it.
#pragma once

#include <cstdint>

namespace intaglio {

// Bytes. Enough for every shipped scene and for textures up to 4096 x 4096.
inline constexpr std::uint64_t default_allowed_memory = 2'000'000'000;

}  // namespace intaglio
