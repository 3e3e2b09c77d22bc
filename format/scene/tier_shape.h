/// The overview levels of a scene as scene.xml lists them: each level consists of overviews of one size, up to one root
/// (scheduler/plan/overviews.h). This list determines the windows of all overviews without naming each overview.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// A function that calls its argument for each cell.
using CellWalk = std::function<void(const std::function<void(const SceneCell&)>&)>;

/// Returns the overview levels, from the lowest to the root. Returns an empty list unless all cells have one common
/// root. They have none if overviews are missing, overlap or differ in shape, or if a cell has no overview. Cells are
/// only checked if the scene records a lost shard.
/// Cost    One pass over all overviews, and over all cells if a shard is lost.
std::vector<TierShape> tiers_of(std::span<const SceneCell> overviews, const SceneHeader& header,
                                std::uint32_t cell_voxels, const CellWalk& for_each_cell);
std::vector<TierShape> tiers_of(const SceneDescription& scene, std::uint32_t cell_voxels);

/// The part of a cell that must lie below overviews. A cell may overlap two blocks of the lowest overview level. If all
/// its voxels lie in one block, the other block may be empty and have no overview. Only the voxels in the shard show
/// this.
enum class CellPart { all, some };

/// Returns whether `part` of each cell lies below overviews of the lowest level. `overviews` must include all overviews
/// of that level.
bool cover_cells(CellPart part, std::span<const SceneCell> overviews, const TierShape& lowest,
                 const CellWalk& for_each_cell);

/// Returns the fault of the overview levels listed for a scene; nullopt if they are valid.
std::optional<std::string> fault_of_tiers(std::span<const TierShape> tiers, std::uint32_t cell_voxels);

/// Returns the fault of an overview that matches none of the levels; nullopt if it matches a level or `tiers` is empty.
std::optional<std::string> fault_in_tiers(const SceneCell& overview, std::span<const TierShape> tiers);

}  // namespace gigabake
