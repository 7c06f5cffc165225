// intaglio study: experiments. Only hands over to its subcommands.
#include "command/study.h"

namespace intaglio::app {

void add_study(CLI::App& app, Common& common) {
  CLI::App* verb = app.add_subcommand("study", "Experiments with people: check a design, register it");
  verb->require_subcommand(1);
  verb->fallthrough();
  add_study_check(*verb, common);
  add_study_preregister(*verb, common);
}

}  // namespace intaglio::app
