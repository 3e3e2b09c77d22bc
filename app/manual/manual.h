/// The commands that document all commands: manual pages and shell completion, generated from the options of --help.
#pragma once

#include <CLI/CLI.hpp>

namespace gigabake::app {

/// Adds the subcommand to `app`, the whole program.
void add_man(CLI::App& app);
void add_completion(CLI::App& app);

}  // namespace gigabake::app
