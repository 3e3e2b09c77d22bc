/// The record of a bake in SCENE/source.json: its source and the options that its result depends on. `edit` bakes the
/// scene again from it.
#pragma once

#include <filesystem>
#include <string>

#include "app/options/bake_options.h"

namespace gigabake::app {

/// Returns the record as JSON. Paths are absolute.
std::string bake_record(const BakeOptions& options);

/// Returns the options of the bake that wrote SCENE/source.json, with SCENE as their `out`.
/// Errors  InputError: SCENE has no such file, or the file is malformed.
BakeOptions recorded_bake(const std::filesystem::path& scene_folder);

}  // namespace gigabake::app
