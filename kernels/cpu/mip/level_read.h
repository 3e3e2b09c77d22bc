/// Functions that read a level to compute coarser levels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/body/mip/patch.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Returns, for each coarser brick, the index in `level` of its first brick. The last entry is the number of bricks in
/// `level`.
///
/// key_above(key) returns the Morton code of the coarser brick that contains brick `key`.
template <class KeyAbove>
std::vector<std::size_t> starts_below(const Level& level, const KeyAbove& key_above) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < level.key.size(); ++i)
    if (i == 0 || key_above(level.key[i]) != key_above(level.key[i - 1])) starts.push_back(i);
  starts.push_back(level.key.size());
  return starts;
}

/// Returns voxel `i` of the level. Its normal is zero if the level has no normals.
inline Voxel voxel_at(const Level& level, std::size_t i) {
  Voxel v{};
  for (std::size_t c = 0; c < 4; ++c) v.rgba[c] = level.rgba[4 * i + c];
  for (std::size_t c = 0; c < 2 && !level.normal.empty(); ++c) v.normal[c] = level.normal[2 * i + c];
  return v;
}

/// Returns the patch of voxel `i` of a lod-0 level that has normals. `n` is the voxel's unit normal.
inline SurfaceMoments finest_patch_at(const Level& finest, std::size_t i, const UnitNormal& n) {
  const std::vector<std::uint8_t>& planes = finest.directional_coverage;
  const std::size_t at = directional_coverage_bytes * i + directional_coverage_plane;
  return finest_patch(planes.empty() ? std::uint8_t(0) : planes[at], n);
}

}  // namespace gigabake::kernels
