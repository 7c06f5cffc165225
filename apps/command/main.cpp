// The `intaglio` command: parses the command line and hands over to one verb.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command/verb.h"
#include "core/text.h"

namespace intaglio::app {

int report(const Error& error) {
  fmt::print(stderr, "intaglio: {}\n", error.message());
  return 1;
}

namespace {

// The first argument that is, or lists, a number that is not finite. No option means one, and ranges do not
// see that nan is outside of them.
std::optional<std::string> unbounded(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    std::string_view rest = argv[k];
    if (rest.starts_with("--")) rest.remove_prefix(std::min(rest.find('='), rest.size() - 1) + 1);
    while (!rest.empty()) {
      const std::string part(rest.substr(0, rest.find(',')));
      rest.remove_prefix(std::min(part.size() + 1, rest.size()));
      char* end = nullptr;
      if (!std::isfinite(std::strtod(part.c_str(), &end)) && end == part.c_str() + part.size())
        return argv[k];
    }
  }
  return std::nullopt;
}

// Which argument, counted from 1, says nothing: "" or --output=, as a shell's variable that is not set leaves
// them; 0: none. Taken for a folder it would be the working folder.
int empty_argument(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string_view word = argv[k];
    if (word.empty() || (word.starts_with("--") && word.find('=') == word.size() - 1)) return k;
  }
  return 0;
}

// Where a verb is wanted and another word stands: what would be right.
std::optional<Error> unknown_verb(const CLI::App& app, int argc, char** argv) {
  const CLI::App* at = &app;
  std::string path = "intaglio";
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word.starts_with("-")) continue;
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* verb : at->get_subcommands(nullptr)) {
      names.push_back(verb->get_name());
      if (verb->get_name() == word) next = verb;
    }
    if (names.empty()) return std::nullopt;
    if (next == nullptr) {
      const std::string nearest = nearest_name(word, names);
      return Error{path, fmt::format("there is no verb \"{}\"", word),
                   nearest.empty() ? fmt::format("one of: {}", fmt::join(names, ", "))
                                   : fmt::format("did you mean \"{}\"?", nearest)};
    }
    at = next;
    path += " " + word;
  }
  return std::nullopt;
}

}  // namespace

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
  if (const int empty = intaglio::app::empty_argument(argc, argv); empty > 0) {
    fmt::print(stderr, "intaglio: argument {} is empty; leave it out, or give what it stands for\n", empty);
    return 2;
  }
  if (const auto argument = intaglio::app::unbounded(argc, argv)) {
    fmt::print(stderr, "intaglio: {}: a number must be finite (of a file of that name, say ./{})\n",
               *argument, *argument);
    return 2;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const auto wrong = intaglio::app::unknown_verb(app, argc, argv);
    if (wrong && error.get_exit_code() != 0) {
      intaglio::app::report(*wrong);
      return 2;
    }
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    // Out of memory and the like: still one line, never a crash.
    return intaglio::app::report({"", fmt::format("stopped: {}", error.what()), ""});
  }
  return common.exit_code;
}
