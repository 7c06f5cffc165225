// The main of every test program. Laws over many bodies, steps or bakes (suite "statistics") need minutes
// under sanitizers and find nothing there that shorter tests of the same code do not: script/test leaves them
// out.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "tests/sampling.h"

int main(int argc, char** argv) {
  doctest::Context context(argc, argv);
  if (intaglio::tests::is_sampled()) context.addFilter("test-suite-exclude", "statistics");
  return context.run();
}
