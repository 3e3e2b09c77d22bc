/// One-line messages for invalid command lines, with the probable correction.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace gigabake::app {

/// Returns the nearest known word whose edit distance is at most a third of its length; ties go to the first. The
/// distance counts letters changed, removed, inserted, or swapped with their neighbour. If no word is near enough,
/// returns the only known word that begins with `word`.
std::optional<std::string> meant_by(const std::string& word, const std::vector<std::string>& known);

/// Returns the message for a command line that `program` could not parse, in at most 300 characters. It reports the
/// first that applies: an unknown command, an unknown option, a surplus word, the parser's message.
std::string usage_error(const CLI::App& program, const CLI::ParseError& error);

}  // namespace gigabake::app
