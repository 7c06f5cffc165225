// What `intaglio inspect` found of a texture, as JSON for programs and as a page for people.
#pragma once

#include <string>

#include "surface/inspect.h"

namespace intaglio::report {

// One object; `green` is "+Y" or "-Y", or null without normals; `polarity` "height", "depth" or "none" (no
// height map).
std::string inspection_json(const surface::Inspection& inspection);

// A self-contained page: the maps as they were understood, a relit preview, the slopes, and what suits the
// surface.
std::string inspection_html(const surface::Inspection& inspection, const std::string& title);

}  // namespace intaglio::report
