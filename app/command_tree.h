/// The commands and their options as a plain value, for the manual and for shells: what --help says, nothing else.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace gigabake::app {

struct CommandOption {
  std::vector<std::string> names;    ///< with dashes, short ones first; a positional's one name
  std::string value;                 ///< what it takes, as TEXT; empty: nothing
  std::vector<std::string> choices;  ///< all that it takes, where that is a list
  std::string default_value, description;
  bool is_positional = false, is_required = false;
};

struct Command {
  std::vector<std::string> path;  ///< gigabake, bench, render
  std::string description;
  std::vector<CommandOption> options;
  std::vector<Command> commands;

  /// The path with `separator` between its words.
  std::string name(const char* separator = " ") const;
  /// All of them, with dashes.
  std::vector<std::string> option_names() const;
};

/// What is not listed in --help is left out.
Command command_tree(const CLI::App& program, const std::string& name);

/// The command itself and all below it, parents first.
std::vector<const Command*> all_commands(const Command& root);

}  // namespace gigabake::app
