#include "intaglio/surface/packed_normal.h"

namespace intaglio::surface {

PackedNormal PackedNormal::pack(const Vec3& normal) {
  const auto packed = [](double n) {
    return static_cast<std::int16_t>(std::lround(std::clamp(n, -1.0, 1.0) * 32767));
  };
  return {packed(normal.x()), packed(normal.y())};
}

}  // namespace intaglio::surface
