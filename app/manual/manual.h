/// The commands that describe all commands: manual pages and completion, from the same options as --help.
#pragma once

#include <CLI/CLI.hpp>

namespace gigabake::app {

/// Each adds its sub-command to `app`, the whole program.
void add_man(CLI::App& app);
void add_completion(CLI::App& app);

}  // namespace gigabake::app
