// intaglio study preregister DESIGN -o FILE: hypotheses, sample size, stop rule, exclusions, analysis, hash.
#include <memory>
#include <string>

#include "command/study.h"
#include "core/file.h"
#include "study/design/design.h"
#include "study/design/design_pages.h"

namespace intaglio::app {

namespace {

struct PreregisterArguments {
  std::string design, output;
};

int run_preregister(const PreregisterArguments& arguments) {
  if (auto fits = check_extension(arguments.output, ".md", "Markdown"); !fits) return report(fits.error());
  const auto design = study::read_design(arguments.design);
  if (!design) return report(design.error());
  if (auto written = write_file(arguments.output, study::preregistration(*design)); !written)
    return report(written.error());
  return 0;
}

}  // namespace

void add_study_preregister(CLI::App& study, Common& common) {
  CLI::App* verb = study.add_subcommand(
      "preregister", "Write hypotheses, sample size, stop rule, exclusions, analysis and the design's hash");
  auto options = std::make_shared<PreregisterArguments>();
  verb->add_option("DESIGN", options->design, "Design file (.toml; docs/study-design.md)")->required();
  verb->add_option("-o,--output", options->output, "Markdown file (.md)")->required();
  verb->footer("Example:\n  intaglio study preregister studies/identification.toml -o out/registration.md");
  verb->callback([options, &common] { common.exit_code = run_preregister(*options); });
}

}  // namespace intaglio::app
