// "Seen": the surface from above, as a height map, with the ways that balls and pen took over it.
#pragma once

#include <string>

#include "intaglio/session/recording.h"

namespace intaglio::session {

// The whole surface, a close-up of where the pen touched when that is a small part of it, and the key. A
// sentence when there is no surface.
std::string seen_html(const Recording& recording);

}  // namespace intaglio::session
