// A session of touch as a file: every tick's pose, contact and force, and which texture it was felt on.
//
// Text, CSV: four lines of header (format, rate, texture, fingerprint of the surface), the names of the
// columns with their units, a row a tick, and a last line with the number of rows and a hash of all before
// it, so that a file that was cut or changed is told from a whole one. Numbers are the shortest that read
// back exactly: a replay (devices/replay.h) gives the same forces to the bit. Not real-time; 400 bytes a
// tick.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/haptics/servo.h"

namespace intaglio::haptics {

struct HapticLog {
  double rate = 1000;                // Hz
  std::string texture;               // its name, one line
  std::uint64_t surface = 0;         // fingerprint of what was felt
  std::vector<ServoSample> samples;  // one a tick, the first at time 0
};

// Of what a tip can feel of a surface: depths, sizes, edge; not where it lies.
std::uint64_t fingerprint(const surface::Surface& surface);

std::string encode_log(double rate, std::string_view texture, std::uint64_t surface,
                       std::span<const ServoSample> samples);
// Errors name the line. `name` stands for the file.
Result<HapticLog> decode_log(std::string_view text, const std::string& name);

}  // namespace intaglio::haptics
