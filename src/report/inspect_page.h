// The result of `intaglio inspect`, as JSON and as an HTML page.
#pragma once

#include <string>

#include "surface/inspect.h"

namespace intaglio::report {

// One object; `green` is "+Y" or "-Y", or null without normals; `polarity` "height", "depth" or "none" (no
// height map).
std::string inspection_json(const surface::Inspection& inspection);

// A self-contained page: the maps as interpreted, a relit preview, the slopes, and the recommended
// representation.
std::string inspection_html(const surface::Inspection& inspection, const std::string& title);

}  // namespace intaglio::report
