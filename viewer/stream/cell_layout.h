/// The cells of a scene in the order that rays find them in: columns by interleaved coordinates, upwards in each.
///
/// A voxel's field reaches half a voxel below the voxel (kernels/cast/scene.h), so it may begin in a place that no cell
/// of the scene covers. *Rim cells* cover it: they have a tree of fields, but no voxels and no shard.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/scene/scene_xml.h"
#include "kernels/cast/scene.h"

namespace gigabake {

inline constexpr std::uint32_t rim_cell = 0xffffffffu;

struct CellLayout {
  std::vector<kernels::CastCell> cells;
  std::vector<std::uint32_t> scene_cell;  ///< of each of `cells`: its index in the scene description, or rim_cell
  std::vector<std::uint64_t> column_key;
  std::vector<std::uint32_t> column_first;

  /// With spans of the arrays above; nothing is in its pools.
  kernels::CastScene scene;
};

/// scene_path: for messages.
/// Errors  InputError: no cells, cells of several sizes, off their lattice, too far apart or one inside the other.
CellLayout lay_out_cells(const SceneDescription& scene, const std::filesystem::path& scene_path);

}  // namespace gigabake
