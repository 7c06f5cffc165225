// skipped(why): reports a test that cannot run on this machine. ctest hides the output of tests that pass, so
// the line also goes into the file that INTAGLIO_SKIPS names, with the test's name; script/test prints that
// file at its end. tests/app/begin.sh is the same for scripts.
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace intaglio::tests {

inline void skipped(const std::string& why) {
  MESSAGE("skipped: " << why);
  if (const char* file = std::getenv("INTAGLIO_SKIPS"); file != nullptr && *file != '\0')
    std::ofstream(file, std::ios::app)
        << why + ": " + doctest::getContextOptions()->currentTest->m_name + "\n";
}

}  // namespace intaglio::tests
