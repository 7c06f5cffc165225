// A verb of the `intaglio` command: adds its options to the parser and, when chosen, runs and returns the
// exit code.
//
// Exit codes: 0 done; 1 the work failed (a file, a device, a bad scene); 2 the command line is wrong; 130,
// 143 stopped by SIGINT, SIGTERM (stop.h).
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/memory.h"
#include "scene/cues.h"
#include "surface/import.h"

namespace intaglio::app {

struct Common {
  bool quiet = false;
  std::uint64_t allowed_memory = default_allowed_memory;  // bytes, for what a file asks for
  int exit_code = 0;
};

void add_render(CLI::App& app, Common& common);
void add_devices(CLI::App& app, Common& common);
void add_import(CLI::App& app, Common& common);
void add_inspect(CLI::App& app, Common& common);
void add_replay(CLI::App& app, Common& common);
void add_bake(CLI::App& app, Common& common);
void add_run(CLI::App& app, Common& common);
void add_sound(CLI::App& app, Common& common);
void add_evaluate(CLI::App& app, Common& common);
void add_study(CLI::App& app, Common& common);

// Prints an error in one line; returns the exit code.
int report(const Error& error);

// Prints an object on standard output; bytes that are not UTF-8 (of file names, say) are replaced.
void print_json(const nlohmann::json& json);

// The values of --green (+Y or -Y) and --polarity (height or depth).
surface::Green parse_green(const std::string& text);
surface::Polarity parse_polarity(const std::string& text);

// The option --fault, for verbs that run scenes: lists in the form of scene::add_faults(), one after the
// other. Wrong ones are errors of the command line.
void add_fault_option(CLI::App& verb, std::vector<std::string>& faults);
// Changes cues by faults that the option has taken.
void put_faults(const std::vector<std::string>& faults, scene::Cues& cues);

}  // namespace intaglio::app
