// Built-in solid shapes by name, as a command line writes them: "sphere:r=0.05", "box:x=0.3,y=0.01,z=0.2",
// "plate:a=0.3,t=0.01" (square, lying: side and thickness), "cylinder:r=0.02,h=0.2" (axis along Y). Metres.
#pragma once

#include <optional>
#include <string>

#include "intaglio/core/error.h"
#include "intaglio/sound/fem/tet_mesh.h"

namespace intaglio::sound {

struct SolidShape {
  enum class Kind { sphere, box, cylinder } kind = Kind::sphere;
  Vec3 size = Vec3::Zero();  // of the bounding box

  double volume() const;
  double area() const;
  // Structured elements (shapes.h) about as large as asked for, larger where more than `max_elements` would
  // be needed.
  TetMesh mesh(double element_size, int max_elements) const;
};

// Whether `text` means a shape and not a file: it starts with a shape's name and ":".
bool is_solid_shape(const std::string& text);
Result<SolidShape> solid_shape(const std::string& text);

}  // namespace intaglio::sound
