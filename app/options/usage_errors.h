/// What is wrong with a command line, in one line that says what was probably meant.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace gigabake::app {

/// The known word that is at most a third of its letters away (one changed, left out, put in, or two swapped count one
/// each); the nearest, of equals the first. Else the only one that begins with the word.
std::optional<std::string> meant_by(const std::string& word, const std::vector<std::string>& known);

/// Of a command line that `program` could not parse: an unknown command, else an unknown option, else a word too many,
/// else what the parser says. At most 300 characters.
std::string usage_error(const CLI::App& program, const CLI::ParseError& error);

}  // namespace gigabake::app
