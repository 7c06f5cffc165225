// The main of every test program. Laws over many bodies, steps or bakes (suite "statistics") need minutes
// under sanitizers and find nothing there that shorter tests of the same code do not: script/test leaves them
// out.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "tests/sampling.h"

// AddressSanitizer reads how large a thread-local block is from the bytes before it, which glibc no longer
// writes. Where they happen to look like a size (Mesa's drivers bring such blocks), LeakSanitizer scans that
// range at exit and crashes: "Tracer caught signal 11". Without the interceptor it scans no such range.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "intercept_tls_get_addr=0";
}

int main(int argc, char** argv) {
  doctest::Context context(argc, argv);
  if (intaglio::tests::is_sampled()) context.addFilter("test-suite-exclude", "statistics");
  return context.run();
}
