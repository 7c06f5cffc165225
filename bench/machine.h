// The machine on which a benchmark runs, in one line: processor, cores, memory, and how busy it is.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

namespace intaglio::bench {

inline std::string machine() {
  std::string processor = "unknown processor";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    processor = line.substr(line.find(':') + 2);
    break;
  }
  const double gib = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE)) / 1073741824;
  double load = 0;
  if (getloadavg(&load, 1) != 1) load = 0;
  return fmt::format("{}, {} cores, {:.0f} GiB, load {:.1f}", processor, std::thread::hardware_concurrency(),
                     gib, load);
}

}  // namespace intaglio::bench
