/// Completion of the command line in shells.
#pragma once

#include <string>

#include "app/command_tree.h"

namespace gigabake::app {

/// A script for the shell to read: sub-commands, options, the values of options that are lists; file names elsewhere.
std::string bash_completion(const Command& root);
std::string zsh_completion(const Command& root);
std::string fish_completion(const Command& root);

}  // namespace gigabake::app
