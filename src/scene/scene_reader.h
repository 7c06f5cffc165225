// Parts of the scene reader: balls and bodies, and the ranges that tables share. Internal to session/.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "contact/shape.h"
#include "core/toml.h"
#include "scene/scene.h"

namespace intaglio::scene {

inline Range positive(const char* says, double high = std::numeric_limits<double>::max()) {
  return {0, high, true, says};
}
inline Range at_least_zero(const char* says, double high = std::numeric_limits<double>::max()) {
  return {0, high, false, says};
}

void read_direction(TomlReader& r, const char* key, Vec3& direction);

// Which texture, and how it is taken.
void read_texture(TomlReader& r, SurfaceSettings& surface);
// The curved base of a ground.
void read_base(TomlReader& r, SurfaceSettings& surface);
// The reliefs of a body of that shape.
void read_reliefs(TomlReader& r, const contact::Shape& shape, std::vector<SurfaceSettings>& reliefs);

// Each adds what the table says; `floor` is the frame of those that ask for it.
void read_ball(TomlReader& r, const SurfaceSettings& floor, std::vector<BallSettings>& balls);
void read_body(TomlReader& r, const SurfaceSettings& floor, std::vector<BodySettings>& bodies);

// Blocks in the shape of letters: compounds of boxes, cut from a 5 x 7 raster.

// `text` is one letter A to Z or a digit; nothing for anything else. It lies on its back: `size` is its width
// (X), thickness (Y) and height (Z, the head towards -Z), metres. Its middle is the origin.
std::optional<contact::Shape> letter_shape(const std::string& text, const Vec3& size);

}  // namespace intaglio::scene
