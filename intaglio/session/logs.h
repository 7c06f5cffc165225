// Event and servo logs as CSV: one header line, SI units in the column names, every digit that tells two
// doubles apart.
#pragma once

#include <string>

#include "intaglio/session/recording.h"

namespace intaglio::session {

std::string events_csv(const Recording& recording);
std::string servo_csv(const Recording& recording);

}  // namespace intaglio::session
