// The report's style sheet, light, dark and for print, and its script: a cursor through all tracks that goes
// with the video. The page says all it has to say without the script.
#pragma once

#include <string_view>

namespace intaglio::session {

extern const std::string_view report_css;
extern const std::string_view report_script;

}  // namespace intaglio::session
