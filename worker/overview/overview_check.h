/// Verifies that an overview's shard matches its children's shards.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

/// Returns one line per level of the overview that does not match its children. Duplicated levels must equal the
/// children's voxels. The overview's own levels must equal the levels that this program computes from the children
/// (docs/format.md, "Overviews"). Own levels written by another version of gigabake are not compared, because that
/// version may have made them differently. `children` are the cells or overviews of the scene that the overview's
/// window overlaps. If a child cannot be read, the comparison stops and reports no fault for it; the child's own check
/// reports it.
/// Cost    Reads each child's downsample state and duplicated levels.
std::vector<std::string> overview_faults(const std::filesystem::path& folder, const SceneHeader& scene,
                                         const SceneCell& overview, std::span<const SceneCell> children);

}  // namespace gigabake
