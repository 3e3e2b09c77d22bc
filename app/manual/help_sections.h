/// Sections of --help and the manual that do not describe options: forms of the arguments, and examples.
#pragma once

#include <string>
#include <vector>

#include "app/commands.h"

namespace gigabake::app {

struct HelpSection {
  std::string title;               ///< for example "Examples"
  std::vector<std::string> lines;  ///< printed unchanged
};

/// Returns the sections of a command. `command` is its full name, such as "gigabake bench render".
std::vector<HelpSection> help_sections(const std::string& command);

/// Appends the sections to the --help of each command.
void add_help_sections(CLI::App& program);

}  // namespace gigabake::app
