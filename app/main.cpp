// The `intaglio` command: parses the command line and hands over to one verb.
#include <fmt/format.h>

#include <exception>

#include "app/verb.h"

namespace intaglio::app {

int report(const Error& error) {
  fmt::print(stderr, "intaglio: {}\n", error.message());
  return 1;
}

}  // namespace intaglio::app

int main(int argc, char** argv) {
  CLI::App app(
      "Intaglio: one texture decides what is seen, felt, heard and how things move on a surface.\n"
      "Start with:  intaglio run   or, without a screen,  intaglio render scenes/brick.toml -o out/brick.mp4");
  app.name("intaglio");
  app.require_subcommand(1);
  app.set_version_flag("--version", "intaglio 0.1.0");
  intaglio::app::Common common;
  app.add_flag("-q,--quiet", common.quiet, "No progress bar, no summary; errors only");
  app.fallthrough();
  intaglio::app::add_run(app, common);
  intaglio::app::add_render(app, common);
  intaglio::app::add_devices(app, common);
  intaglio::app::add_import(app, common);
  intaglio::app::add_inspect(app, common);
  intaglio::app::add_replay(app, common);
  intaglio::app::add_bake(app, common);
  intaglio::app::add_sound(app, common);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    // Out of memory and the like: still one line, never a crash.
    return intaglio::app::report({"", fmt::format("stopped: {}", error.what()), ""});
  }
  return common.exit_code;
}
