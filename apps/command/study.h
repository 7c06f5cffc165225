// The subcommands of `intaglio study`, a file each: study_NAME.cpp. Each adds itself to the verb's parser.
#pragma once

#include "command/verb.h"

namespace intaglio::app {

void add_study_check(CLI::App& study, Common& common);
void add_study_preregister(CLI::App& study, Common& common);

}  // namespace intaglio::app
