/// Bakes a hard scene with the pipeline of every bake: files, tiles, a cell, its shard, its voxels.
#pragma once

#include <filesystem>

#include "bench/hard/hard_case.h"
#include "format/source/source.h"

namespace gigabake::bench {

/// Bakes the scene and replaces `folder`.
/// Errors  InputError: as a bake; the cell's own error if the cell failed.
HardBake bake_hard(const std::filesystem::path& folder, const HardScene& scene, const HardCase& hard,
                   const HardMachine& machine, const SceneSources& sources);
/// Writes the scene and opens its files like a bake.
SceneSources open_hard(const std::filesystem::path& folder, const HardScene& scene);

}  // namespace gigabake::bench
