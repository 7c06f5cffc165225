// Another program run to its end, or ended: for work that may crash, hang or eat all memory.
//
// The program runs in a folder that is given, with its output thrown away, in a process group that is killed
// when its time is over. Blocks, any thread. POSIX.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "intaglio/error.h"

namespace intaglio {

struct ProcessLimits {
  double seconds = 60;
  double memory_mb = 4000;  // of address space; 0: no limit
};

// Succeeds when the program ends with exit code 0. The error says what it did instead: "took more than 60 s",
// "crashed (Segmentation fault)", "ended with code 3", "cannot be started: ...".
Result<void> run_limited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const std::filesystem::path& folder, const ProcessLimits& limits);

}  // namespace intaglio
