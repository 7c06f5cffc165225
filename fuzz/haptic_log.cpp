// Any text as a haptic log: a log, or one clear error on one line.
#include "haptics/haptic_log.h"
#include "fuzz/require.h"

using namespace intaglio;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto log = haptics::decode_log(fuzz::as_text(data, size), "fuzz.csv");
  if (!log) fuzz::require_clear(log.error(), "fuzz.csv:");
  return 0;
}
