/// The line and the exit code of a command that read an incomplete scene, in one place for all commands.
#pragma once

#include <filesystem>

namespace gigabake::app {

/// Notes what the scene lacks, for report_missing_data(). A scene that cannot be read is left to the command.
/// scene_argument() calls it for every scene that a command line names.
void note_missing_data(const std::filesystem::path& scene_xml);

/// Prints one line for each noted scene that lacks data, at its first call.
/// Returns `exit_code`, but cells_failed in place of complete if a scene lacks data.
int report_missing_data(int exit_code);

/// Leaves the line to rank 0; the exit code stays the same on all ranks.
void silence_missing_data();

}  // namespace gigabake::app
