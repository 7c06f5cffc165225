// How a surface's texture is taken by every sense: not at all, by its normals alone, or by its depth and
// normals.
#pragma once

namespace intaglio {

enum class Representation { flat, normal, relief };

}  // namespace intaglio
