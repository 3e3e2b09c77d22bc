/// The commands of `gigabake bench`. Each file turns arguments into one call and its result into text or JSON.
#pragma once

#include <CLI/CLI.hpp>

namespace gigabake::app {

/// Adds `bench` with all its subcommands and their options to `program`. A callback sets `exit_code` and throws
/// UsageError or InputError.
void add_bench(CLI::App& program, int& exit_code);
/// Adds the options of one subcommand to `bench`.
void add_bench_accuracy(CLI::App& bench, int& exit_code);
void add_bench_edit(CLI::App& bench, int& exit_code);
void add_bench_pack(CLI::App& bench, int& exit_code);
void add_bench_query(CLI::App& bench, int& exit_code);
void add_bench_render(CLI::App& bench, int& exit_code);

}  // namespace gigabake::app
