/// What --help and the manual say of a command besides its options: what its arguments may be, and examples.
#pragma once

#include <string>
#include <vector>

#include "app/commands.h"

namespace gigabake::app {

struct HelpSection {
  std::string title;               ///< "Examples"
  std::vector<std::string> lines;  ///< printed as they are
};

/// command: its words, "gigabake bench render".
std::vector<HelpSection> help_sections(const std::string& command);

/// To the end of each command's --help.
void add_help_sections(CLI::App& program);

}  // namespace gigabake::app
