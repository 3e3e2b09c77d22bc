/// The program gigabake-bench, which contains the benchmarks. `gigabake bench` starts it. gigabake links neither the
/// benchmarks nor their references, Embree and GMP.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/command_tree.h"

namespace gigabake::app {

/// The first argument of gigabake-bench if gigabake started it; the value is gigabake's build_version().
inline constexpr const char* bench_caller_option = "--caller=";
/// The argument with which gigabake-bench prints the JSON text of its command tree, and ends.
inline constexpr const char* bench_tree_option = "--list-options";

/// Adds the command `bench` and its subcommands, still without options. Both programs know the names and descriptions,
/// so that help lists them without gigabake-bench.
CLI::App& declare_bench(CLI::App& program);

/// Adds `bench` to gigabake. `arguments` is gigabake's whole command line. A subcommand replaces this process by
/// gigabake-bench, which parses the arguments after the subcommand.
void add_bench_starter(CLI::App& program, const std::vector<std::string>& arguments);

/// Returns the tree of `bench` with all options, as gigabake-bench prints it; nullopt if that program is missing.
std::optional<Command> bench_tree();

/// Returns the program gigabake that belongs to this gigabake-bench.
/// Errors  std::runtime_error: it is missing.
std::filesystem::path caller_program();

/// Returns the error line if another version of gigabake started this gigabake-bench; else nullopt. `caller` is the
/// build_version() of the gigabake that started it.
std::optional<std::string> other_version_error(const std::string& caller);

}  // namespace gigabake::app
