// intaglio replay LOG [--scene SCENE] [-o PAGE.html]
#include <fmt/format.h>

#include <memory>

#include "command/verb.h"
#include "core/file.h"
#include "report/haptic_replay.h"

namespace intaglio::app {

namespace {

struct ReplayArguments {
  std::string log, scene, page;
};

int run_replay(const ReplayArguments& options, const Common& common) {
  if (!options.page.empty()) {
    if (auto named = check_extension(options.page, ".html", "a page"); !named) return report(named.error());
    if (auto writable = check_writable(options.page); !writable) return report(writable.error());
  }
  const auto log = report::read_haptic_log(options.log);
  if (!log) return report(log.error());
  if (!common.quiet) fmt::print("{}", report::haptic_summary(*log));
  if (!options.scene.empty()) {
    const auto scene = scene::read_scene(options.scene, common.allowed_memory);
    if (!scene) return report(scene.error());
    const auto replayed = report::replay(*log, *scene);
    if (!replayed) return report(replayed.error());
    fmt::print("replayed on {}: largest force difference {} N\n", options.scene,
               replayed->largest_difference);
    if (!replayed->same_surface) fmt::print("warning: it was recorded on another surface\n");
  }
  if (!options.page.empty()) {
    if (auto written = write_file(options.page, report::haptic_page(*log, options.log)); !written)
      return report(written.error());
  }
  return 0;
}

}  // namespace

void add_replay(CLI::App& app, Common& common) {
  CLI::App* verb = app.add_subcommand("replay", "Plot a haptic log; replay it on a scene");
  auto options = std::make_shared<ReplayArguments>();
  verb->add_option("LOG", options->log, "A haptic log (.servo.csv, docs/haptics.md)")->required();
  verb->add_option("--scene", options->scene,
                   "Replay the motion on this scene's surface and compare the forces");
  verb->add_option("-o,--output", options->page, "A page of height and force over time, .html");
  verb->footer(
      "Example:\n  intaglio replay out/demo/brick.servo.csv --scene scenes/brick.toml -o out/demo/felt.html");
  verb->callback([options, &common] { common.exit_code = run_replay(*options, common); });
}

}  // namespace intaglio::app
