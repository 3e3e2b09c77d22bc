/// Command-line completion for shells.
#pragma once

#include <string>

#include "app/command_tree.h"

namespace gigabake::app {

/// Returns a script for the shell. The script completes subcommands, options and listed values of options. All other
/// words are completed as file names.
std::string bash_completion(const Command& root);
std::string zsh_completion(const Command& root);
std::string fish_completion(const Command& root);

}  // namespace gigabake::app
