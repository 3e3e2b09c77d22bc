/// The message and the exit code for incomplete scenes, shared by all commands.
#pragma once

#include <filesystem>

namespace gigabake::app {

/// Records missing data of the scene for report_missing_data(). Ignores a scene that cannot be read; the command
/// reports that error. scene_argument() calls it for every scene on the command line.
void record_missing_data(const std::filesystem::path& scene_xml);

/// Prints one line per recorded scene that lacks data, at the first call only. Returns `exit_code`. If a scene lacks
/// data, returns cells_failed in place of `complete`.
int report_missing_data(int exit_code);

/// Suppresses the lines of report_missing_data(). Ranks other than 0 call it; the exit code stays the same on all
/// ranks.
void silence_missing_data();

}  // namespace gigabake::app
