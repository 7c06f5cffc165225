// Readers of a scene file's textures, balls and bodies, and the ranges that they share. Internal to scene/.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "contact/shape.h"
#include "core/toml.h"
#include "scene/scene.h"

namespace intaglio::scene {

inline Range positive(const char* message, double high = std::numeric_limits<double>::max()) {
  return {0, high, true, message};
}
inline Range at_least_zero(const char* message, double high = std::numeric_limits<double>::max()) {
  return {0, high, false, message};
}

void read_direction(TomlReader& r, const char* key, Vec3& direction);

// Texture name and import options.
void read_texture(TomlReader& r, SurfaceSettings& surface);
// The curved base of a ground.
void read_base(TomlReader& r, SurfaceSettings& surface);
// The reliefs of a body of that shape.
void read_reliefs(TomlReader& r, const contact::Shape& shape, std::vector<SurfaceSettings>& reliefs);

// Each appends one entry. `floor` is the frame of tables with frame = "floor".
void read_ball(TomlReader& r, const SurfaceSettings& floor, std::vector<BallSettings>& balls);
void read_body(TomlReader& r, const SurfaceSettings& floor, std::vector<BodySettings>& bodies);

// A block in the shape of a letter: a compound of boxes, cut from a 5 x 7 raster.
//
// `text` is one letter A to Z or a digit; nullopt for anything else. The letter lies on its back, centred on
// the origin: `size` is its width (X), thickness (Y) and height (Z, head towards -Z), metres.
std::optional<contact::Shape> letter_shape(const std::string& text, const Vec3& size);

}  // namespace intaglio::scene
