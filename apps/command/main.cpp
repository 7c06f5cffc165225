// The `intaglio` command: parses the command line and hands over to one verb.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "command/stop.h"
#include "command/verb.h"
#include "core/budget.h"
#include "core/text.h"
#include "intaglio/version.h"

namespace intaglio::app {

int report(const Error& error) {
  wait_if_stopped();
  print_error(fmt::format("intaglio: {}\n", error.message()));
  return 1;
}

void print_json(const nlohmann::json& json) {
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

surface::Green parse_green(const std::string& text) {
  return text == "+Y" ? surface::Green::plus_y : surface::Green::minus_y;
}

surface::Polarity parse_polarity(const std::string& text) {
  return text == "height" ? surface::Polarity::height : surface::Polarity::depth;
}

void add_fault_option(CLI::App& verb, std::vector<std::string>& faults) {
  const auto check = [](const std::string& text) {
    scene::Cues cues;
    const auto added = scene::add_faults(cues, text);
    return added ? std::string() : added.error().message();
  };
  verb.add_option(
          "--fault", faults,
          "Senses that are given something else, e.g. sound-delay=60ms,touch-shift=10mm,picture=TEXTURE,motion=off "
          "(docs/cues.md)")
      ->type_name("LIST")
      ->allow_extra_args(false)
      ->check(check);
}

void put_faults(const std::vector<std::string>& faults, scene::Cues& cues) {
  for (const std::string& list : faults) (void)scene::add_faults(cues, list);
}

namespace {

// The first argument that is, or lists, a number that is not finite. No option accepts one, and CLI::Range
// lets NaN through.
std::optional<std::string> non_finite_argument(int argc, char** argv) {
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

// Index, from 1, of the first empty argument, "" or --output=, which an unset shell variable leaves; 0: none.
// As a folder it would be the working folder.
int empty_argument(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string_view word = argv[k];
    if (word.empty() || (word.starts_with("--") && word.find('=') == word.size() - 1)) return k;
  }
  return 0;
}

// Opens standard streams that the caller has closed: otherwise the first files that we open would take their
// numbers, and messages would go into them. Results to a closed standard output fail, as on a full disk.
void open_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    if (stream != STDOUT_FILENO || open("/dev/full", O_WRONLY) != stream) (void)open("/dev/null", O_RDWR);
  }
}

// An exit code of 0 promises that all that was printed has arrived.
int flush_output(int code) {
  wait_if_stopped();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return report({"standard output", fmt::format("cannot be written: {}", std::strerror(errno)), ""});
}

// The error for an unknown command, with the nearest name.
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
      return Error{path, fmt::format("unknown command \"{}\"", word),
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
  intaglio::app::open_closed_streams();
  intaglio::app::watch_for_stop();
  std::signal(SIGCHLD, SIG_DFL);  // a parent that ignores it would hide how children end
  CLI::App app(
      "Intaglio: one texture decides what is seen, felt, heard and how things move on a surface.\n"
      "Start with:  intaglio run   or, without a screen,  intaglio render scenes/brick.toml -o out/brick.mp4");
  app.name("intaglio");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("intaglio ") + intaglio::version());
  intaglio::app::Common common;
  app.add_flag("-q,--quiet", common.quiet, "No progress bar, no summary; errors only")
      ->each([](const std::string&) { intaglio::app::stop_quietly(); });
  app.add_option_function<std::string>(
         "--allow-memory",
         [&common](const std::string& text) {
           const auto bytes = intaglio::memory_size(text);
           if (!bytes)
             throw CLI::ValidationError("--allow-memory", text + " is not a size, such as 8G or 500M");
           common.allowed_memory = *bytes;
         },
         "Memory that a scene, mesh or texture may need, such as 8G or 500M; more is refused  [2G]")
      ->type_name("SIZE");
  app.fallthrough();
  intaglio::app::add_run(app, common);
  intaglio::app::add_render(app, common);
  intaglio::app::add_devices(app, common);
  intaglio::app::add_import(app, common);
  intaglio::app::add_inspect(app, common);
  intaglio::app::add_replay(app, common);
  intaglio::app::add_bake(app, common);
  intaglio::app::add_sound(app, common);
  intaglio::app::add_evaluate(app, common);
  intaglio::app::add_study(app, common);
  if (const int empty = intaglio::app::empty_argument(argc, argv); empty > 0) {
    intaglio::print_error(fmt::format("intaglio: argument {} is empty (an unset shell variable?)\n", empty));
    return 2;
  }
  if (const auto argument = intaglio::app::non_finite_argument(argc, argv)) {
    intaglio::print_error(fmt::format(
        "intaglio: {}: not a finite number (for a file of that name, write ./{})\n", *argument, *argument));
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
    return code == 0 ? intaglio::app::flush_output(0) : 2;
  } catch (const std::system_error& error) {
    const bool is_output = std::ferror(stdout) != 0;
    return intaglio::app::report(
        {is_output ? "standard output" : "",
         fmt::format("{}: {}", is_output ? "cannot be written" : "stopped", error.code().message()), ""});
  } catch (const std::exception& error) {
    // Out of memory and the like: still one line, never a crash.
    return intaglio::app::report({"", fmt::format("stopped: {}", error.what()), ""});
  }
  return intaglio::app::flush_output(common.exit_code);
}
