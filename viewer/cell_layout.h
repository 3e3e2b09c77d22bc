/// The cells of a scene in the order that rays find them in: columns by interleaved coordinates, upwards in each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/scene_xml.h"
#include "kernels/cast_scene.h"

namespace gigabake {

struct CellLayout {
  std::vector<kernels::CastCell> cells;   ///< nothing is here yet
  std::vector<std::uint32_t> scene_cell;  ///< of each of `cells`: its index in the scene description
  std::vector<std::uint64_t> column_key;
  std::vector<std::uint32_t> column_first;

  /// With spans of the arrays above.
  kernels::CastScene scene;
};

/// scene_path: for messages.
/// Errors  InputError: no cells, cells of several sizes, off their lattice, too far apart or one inside the other.
CellLayout lay_out_cells(const SceneDescription& scene, const std::filesystem::path& scene_path);

}  // namespace gigabake
