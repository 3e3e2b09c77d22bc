/// A hard scene through the pipeline that bakes everything: files, tiles, a cell, its shard, its voxels.
#pragma once

#include <filesystem>

#include "bench/hard/hard_case.h"
#include "format/source/source.h"

namespace gigabake::bench {

/// Replaces `folder`. Errors  InputError: as a bake; the cell's own error where it failed.
HardBake bake_hard(const std::filesystem::path& folder, const HardScene& scene, const HardCase& hard,
                   const HardMachine& machine, const SceneSources& sources);
/// Writes the scene and opens it as a bake does.
SceneSources open_hard(const std::filesystem::path& folder, const HardScene& scene);

}  // namespace gigabake::bench
