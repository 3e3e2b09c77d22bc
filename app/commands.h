/// The subcommands. Each file turns arguments into one library call, and the result of the call into text or JSON.
/// Commands contain no other logic.
#pragma once

#include <CLI/CLI.hpp>

namespace gigabake::app {

/// Exit codes, the same for every command (docs/cluster.md).
enum ExitCode : int { complete = 0, failed = 1, usage = 2, cells_failed = 3, rank_lost = 69, drained = 75 };

/// Adds the subcommand to `app`; its callback sets `exit_code` and throws UsageError or InputError.
void add_sample(CLI::App& app, int& exit_code);
void add_plan(CLI::App& app, int& exit_code);
void add_bake(CLI::App& app, int& exit_code);
void add_edit(CLI::App& app, int& exit_code);
void add_status(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);
void add_verify(CLI::App& app, int& exit_code);
void add_diff(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_render(CLI::App& app, int& exit_code);
void add_query(CLI::App& app, int& exit_code);
void add_view(CLI::App& app, int& exit_code);
void add_serve(CLI::App& app, int& exit_code);
/// Adds the hidden command that a rank's supervisor starts. Its callback ends the process.
void add_bake_process(CLI::App& app);

}  // namespace gigabake::app
