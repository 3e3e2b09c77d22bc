/// One-line messages for invalid command lines, with the probable correction.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace gigabake::app {

/// Returns the known word nearest to `word`, if their edit distance is at most a third of the known word's length. If
/// several words are nearest, returns the first. The distance counts letters changed, removed, inserted, or swapped
/// with their neighbour. If no word is near enough, returns the only known word that begins with `word`.
std::optional<std::string> meant_by(const std::string& word, const std::vector<std::string>& known);

/// Returns the message, in one line, for a command line that `program` could not parse. It reports the first problem
/// that exists in this order: unknown command, unknown option, surplus word, missing command or argument, other error.
std::string usage_error(const CLI::App& program, const CLI::ParseError& error);

}  // namespace gigabake::app
