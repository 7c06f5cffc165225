// Any text as a haptic log: a log, or one clear error on one line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "haptics/haptic_log.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto log = intaglio::haptics::decode_log({reinterpret_cast<const char*>(data), size}, "fuzz.csv");
  if (log) return 0;
  const std::string message = log.error().message();
  if (message.find('\n') != std::string::npos || message.find("fuzz.csv:") != 0) std::abort();
  return 0;
}
