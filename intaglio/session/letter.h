// Blocks in the shape of letters: compounds of boxes, cut from a 5 x 7 raster.
#pragma once

#include <optional>
#include <string>

#include "intaglio/contact/shape.h"

namespace intaglio::session {

// `text` is one letter A to Z or a digit; nothing for anything else. It lies on its back: `size` is its width
// (X), thickness (Y) and height (Z, the head towards -Z), metres. Its middle is the origin.
std::optional<contact::Shape> letter_shape(const std::string& text, const Vec3& size);

}  // namespace intaglio::session
