/// The levels above the cells as scene.xml says them: tiers of parents side by side, up to one root
/// (scheduler/parents.h). Who knows the tiers finds a parent without having seen the others.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/scene/scene_xml.h"

namespace gigabake {

/// Calls what it is given for each cell.
using CellWalk = std::function<void(const std::function<void(const SceneCell&)>&)>;

/// From the cells upwards. Nothing where not all of a scene hangs from one root: no parents, or parents that are
/// missing, overlap or are of no such shape; or where a cell has none, which is looked at if the scene says that a
/// shard is lost.
/// Cost  Looks at all parents, and where a shard is lost at all cells.
std::vector<TierShape> tiers_of(std::span<const SceneCell> parents, const SceneHeader& header,
                                std::uint32_t cell_voxels, const CellWalk& for_each_cell);
std::vector<TierShape> tiers_of(const SceneDescription& scene, std::uint32_t cell_voxels);

/// A cell may reach into two blocks of the lowest tier. Where its voxels all lie in one of them, the other may be empty
/// and then has no parent: nobody knows without the shard.
enum class CellPart { all, some };

/// Whether so much of each cell lies below parents of the lowest tier, of which `parents` are all.
bool hold_cells(CellPart part, std::span<const SceneCell> parents, const TierShape& lowest,
                const CellWalk& for_each_cell);

/// What is wrong with tiers that somebody says a scene has; nothing where there can be such.
std::optional<std::string> fault_of_tiers(std::span<const TierShape> tiers, std::uint32_t cell_voxels);

/// What is wrong with a parent, which should be of one of the tiers; nothing where there are none.
std::optional<std::string> fault_in_tiers(const SceneCell& parent, std::span<const TierShape> tiers);

}  // namespace gigabake
