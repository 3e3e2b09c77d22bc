/// Whether a parent's shard is what its children's shards make of it: for who verifies a scene.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

/// One line for each level of the parent that is not what its children say: copies must be their voxels, and its own
/// levels what this program makes of them (docs/format.md). Levels that another version of gigabake has made
/// are not compared, for it may have made them otherwise; copies always are.
/// children: those cells or parents of the scene that its window overlaps. One that cannot be read ends the comparison
/// without a line: it is named where it is checked itself.
/// Cost  reads of each child what levels above are made of, and the levels that are copied.
std::vector<std::string> faults_of_parent(const std::filesystem::path& folder, const SceneHeader& scene,
                                          const SceneCell& parent, std::span<const SceneCell> children);

}  // namespace gigabake
