// intaglio study check DESIGN: what a participant goes through, how long it takes, how orders balance, power.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "command/study.h"
#include "study/design/design.h"
#include "study/design/design_pages.h"

namespace intaglio::app {

namespace {

struct StudyCheckArguments {
  std::string design;
  int participants = 0, participant = 1;
};

int run_study_check(const StudyCheckArguments& arguments) {
  const auto design = study::read_design(arguments.design);
  if (!design) return report(design.error());
  const int n = arguments.participants > 0 ? arguments.participants : design->stop.participants;
  const auto text = study::check_text(*design, n, arguments.participant);
  if (!text) return report(text.error());
  fmt::print("{}", *text);
  return 0;
}

}  // namespace

void add_study_check(CLI::App& study, Common& common) {
  CLI::App* verb = study.add_subcommand(
      "check", "Say what a participant goes through, how long it takes, how orders balance, and the power");
  auto options = std::make_shared<StudyCheckArguments>();
  verb->add_option("DESIGN", options->design, "Design file (.toml; docs/study-design.md)")->required();
  verb->add_option("-n,--participants", options->participants, "Participants  [the design's]")
      ->check(CLI::Range(1, study::most_participants));
  verb->add_option("--participant", options->participant, "The participant whose session is listed  [1]")
      ->check(CLI::Range(1, study::most_participants));
  verb->footer("Example:\n  intaglio study check studies/identification.toml -n 12");
  verb->callback([options, &common] { common.exit_code = run_study_check(*options); });
}

}  // namespace intaglio::app
