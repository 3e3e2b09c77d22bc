/// The commands and their options as a plain value, for the manual and for shell completion. The tree contains only
/// commands and options that --help lists.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace gigabake::app {

struct CommandOption {
  std::vector<std::string> names;    ///< with dashes, short names first; the single name of a positional
  std::string value;                 ///< type of the value, such as TEXT; empty: takes none
  std::vector<std::string> choices;  ///< all accepted values, if they are a list
  std::string default_value, description;
  bool is_positional = false, is_required = false;
};

struct Command {
  std::vector<std::string> path;  ///< for example gigabake, bench, render
  std::string description;
  std::vector<CommandOption> options;
  std::vector<Command> commands;

  /// Returns the path with `separator` between its words.
  std::string name(const char* separator = " ") const;
  /// Returns all option names, with dashes.
  std::vector<std::string> option_names() const;
};

/// Returns the tree of the commands and options that --help lists. Omits hidden commands and options.
Command command_tree(const CLI::App& program, const std::string& name);

/// Returns the command as JSON text, which command_from_json() reads.
std::string to_json(const Command& command);

/// Errors  nlohmann::json::exception: not a text of to_json().
Command command_from_json(const std::string& text);

/// Returns the command itself and all commands below it, parents first.
std::vector<const Command*> all_commands(const Command& root);

}  // namespace gigabake::app
