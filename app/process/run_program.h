/// The course of a program from its arguments to its exit code, shared by gigabake and gigabake-bench.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace gigabake::app {

/// Adds the commands to `program`. The callback of the parsed command sets `exit_code`.
using AddCommands = std::function<void(CLI::App& program, int& exit_code)>;

/// Parses the arguments, runs the command and returns the exit code. Prints one line for an error. Call it before any
/// file is opened.
int run_program(int argc, const char* const* argv, const AddCommands& add_commands);

}  // namespace gigabake::app
