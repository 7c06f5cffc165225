// Any text as a file of thresholds: each pair with positive thresholds, or one clear error on one line.
#include "evaluate/thresholds.h"
#include "fuzz/require.h"

using namespace intaglio;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto thresholds = evaluate::parse_thresholds(fuzz::as_text(data, size), "fuzz.toml");
  if (!thresholds) {
    fuzz::require_clear(thresholds.error(), "fuzz.toml");
    return 0;
  }
  for (int k = 0; k < evaluate::pair_count; ++k) {
    const auto pair = evaluate::Pair(k);
    for (const auto first :
         {evaluate::First::either, evaluate::First::sight, evaluate::First::touch, evaluate::First::sound}) {
      fuzz::require(thresholds->T(pair, first) > 0);
      fuzz::require(thresholds->T(pair) <= thresholds->T(pair, first));
    }
    fuzz::require(thresholds->S(pair) > 0);
  }
  return 0;
}
