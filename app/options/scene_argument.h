/// What somebody named on the command line where a baked scene, or a source, is asked for.
#pragma once

#include <filesystem>
#include <string>

namespace gigabake::app {

/// OUT/scene.xml, for that name itself and for OUT. What is not there, or cannot be told, is given back as it is, and
/// its reader says so. What the scene lacks is noted for the command's exit code (app/process/missing_report.h).
/// Errors  InputError: a source, a shard, or a folder without a scene.xml; says what it is and what to do instead.
std::filesystem::path scene_argument(const std::string& given);

/// As scene_argument(), of a bake that may be under way or still to start: there may be no scene.xml, or no folder,
/// yet.
/// Errors  InputError: also a name with no folder above it, or one that is probably a misspelt bake in the same folder.
std::filesystem::path live_scene_argument(const std::string& given);

/// OUT, for that name itself and for OUT/scene.xml. Errors  InputError as scene_argument().
std::filesystem::path bake_folder_argument(const std::string& given);

/// Errors  InputError: the folder that a bake is to write holds sources, or belongs to another bake's OUT.
void expect_bake_output(const std::string& given);

/// Errors  InputError: a baked scene or a shard where a source is asked for.
void expect_source(const std::string& given);

}  // namespace gigabake::app
