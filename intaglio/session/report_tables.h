// The report's tables: what each sense cost, figures of the run, and the voices.
#pragma once

#include <string>

#include "intaglio/session/recording.h"

namespace intaglio::session {

std::string cost_table(const Recording& recording);
std::string run_table(const Recording& recording);
std::string voice_table(const Recording& recording);

}  // namespace intaglio::session
