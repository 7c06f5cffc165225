// A verb of the `intaglio` command: adds its options to the parser and, when chosen, runs and returns the
// exit code.
//
// Exit codes: 0 done; 1 the work failed (a file, a device, a bad scene); 2 the command line is wrong; 130
// interrupted.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "intaglio/error.h"

namespace intaglio::app {

struct Common {
  bool quiet = false;
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

// Prints an error as the one line it is; returns the exit code.
int report(const Error& error);

}  // namespace intaglio::app
