/// Paths of baked scenes and of sources on the command line.
#pragma once

#include <filesystem>
#include <string>

namespace gigabake::app {

/// Returns SCENE/scene.xml if `given` is that file or SCENE. Returns a path that is missing or cannot be classified
/// unchanged; its reader reports the error. Records missing data of the scene for the command's exit code
/// (app/process/missing_report.h).
/// Errors  InputError: a source, a shard, or a folder without a scene.xml. The message names its class and the command
///         to use instead.
std::filesystem::path scene_argument(const std::string& given);

/// Returns the scene.xml of a bake that may be running or not started yet. Unlike in scene_argument(), scene.xml and
/// its folder need not exist yet.
/// Errors  InputError as in scene_argument(). InputError also for a name without a parent folder, and for a name that
///         is probably a misspelt bake in the same folder.
std::filesystem::path live_scene_argument(const std::string& given);

/// Returns SCENE if `given` is SCENE or SCENE/scene.xml.
/// Errors  InputError: `given` is a source or a shard file.
std::filesystem::path bake_folder_argument(const std::string& given);

/// Checks the output folder of a bake.
/// Errors  InputError: the folder contains sources, or belongs to another bake's SCENE.
void expect_bake_output(const std::string& given);

/// Checks that `given` is neither a baked scene nor a shard.
/// Errors  InputError: `given` is a baked scene or a shard.
void expect_source(const std::string& given);

}  // namespace gigabake::app
