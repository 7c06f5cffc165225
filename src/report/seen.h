// The report's section "Seen".
#pragma once

#include <string>

#include "report/digest.h"

namespace intaglio::report {

// The height map from above, with the paths of balls and pen; a close-up of where the pen touched if that is
// a small part of it; a legend. A placeholder sentence without a surface.
std::string seen_html(const Digest& digest);

}  // namespace intaglio::report
