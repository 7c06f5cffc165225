// How much memory a file may ask for. Scenes, meshes and textures say in their first bytes what they need;
// what would need more than is allowed is refused with the figure, before anything large is allocated
// (docs/trust.md, Budgets). Options of what reads files have a field for it; a file cannot raise its own.
#pragma once

#include <cstdint>

namespace intaglio {

// Bytes. Enough for every shipped scene and for textures up to 4096 x 4096.
inline constexpr std::uint64_t default_allowed_memory = 2'000'000'000;

}  // namespace intaglio
