/// The overview levels of a scene as scene.xml lists them: each level consists of overviews of one size, up to one root
/// (scheduler/plan/overviews.h). They determine where overviews are, without listing the overviews.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Calls its argument for each cell.
using CellWalk = std::function<void(const std::function<void(const SceneCell&)>&)>;

/// Returns the overview levels from the cells up. Returns none unless all cells have one common root: no overviews;
/// overviews that are missing, overlap, or differ in shape; or a cell without one. Cells are only checked if the scene
/// records a lost shard.
/// Cost    One pass over all overviews, and over all cells if a shard is lost.
std::vector<TierShape> tiers_of(std::span<const SceneCell> overviews, const SceneHeader& header,
                                std::uint32_t cell_voxels, const CellWalk& for_each_cell);
std::vector<TierShape> tiers_of(const SceneDescription& scene, std::uint32_t cell_voxels);

/// The part of a cell that must lie below overviews. A cell may overlap two blocks of the lowest overview level. If all
/// its voxels lie in one block, the other may be empty and have no overview; only the shard's voxels could tell.
enum class CellPart { all, some };

/// Returns whether that part of each cell lies below overviews of the lowest level. `overviews` are all overviews of
/// that level.
bool cover_cells(CellPart part, std::span<const SceneCell> overviews, const TierShape& lowest,
                 const CellWalk& for_each_cell);

/// Returns the fault of the overview levels listed for a scene; nullopt if they are valid.
std::optional<std::string> fault_of_tiers(std::span<const TierShape> tiers, std::uint32_t cell_voxels);

/// Returns the fault of an overview that should belong to one of the levels; nullopt if it is valid or `tiers` is
/// empty.
std::optional<std::string> fault_in_tiers(const SceneCell& overview, std::span<const TierShape> tiers);

}  // namespace gigabake
