// What a body's shape looks like: a mesh in the body's frame for the renderer. Pure; milliseconds.
#pragma once

#include "intaglio/contact/shape.h"
#include "intaglio/render/mesh.h"

namespace intaglio::session {

render::Mesh shape_mesh(const contact::Shape& shape);

}  // namespace intaglio::session
