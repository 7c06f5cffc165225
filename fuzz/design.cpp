// Any text as a design: a design whose first participants have plans, or one clear error on one line. Plans
// keep their laws: the same plan again, and no material at two levels of a split factor.
#include "study/design/design.h"

#include <map>
#include <string>

#include "fuzz/require.h"
#include "study/design/plan.h"

using namespace intaglio;

namespace {

void require_split(const study::Design& design, const study::Plan& plan) {
  std::map<std::string, std::string> met;  // by factor and material
  for (const study::PlannedStep& step : plan.steps)
    for (const study::PlannedItem& item : step.items)
      for (const std::string& level : item.levels) {
        const std::string factor = level.substr(0, level.find('='));
        if (design.find_factor(factor)->assign != study::Factor::Assign::split) continue;
        const auto [at, is_new] = met.try_emplace(factor + "/" + item.material, level);
        fuzz::require(is_new || at->second == level);
      }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto design = study::parse_design(fuzz::as_text(data, size), "fuzz.toml");
  if (!design) {
    fuzz::require_clear(design.error(), "fuzz.toml");
    return 0;
  }
  if (auto texts = study::parse_texts(fuzz::as_text(data, size), "fuzz.toml", "xx", *design); !texts)
    fuzz::require_clear(texts.error(), "fuzz.toml");
  for (const int participant : {1, 2}) {
    const auto plan = study::plan(*design, participant);
    if (!plan) {
      fuzz::require_clear(plan.error(), "fuzz.toml");
      return 0;
    }
    fuzz::require(study::plan_hash(*plan) == study::plan_hash(*study::plan(*design, participant)));
    require_split(*design, *plan);
  }
  return 0;
}
