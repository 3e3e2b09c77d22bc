/// A level as those read it who make coarser ones of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Where the bricks start that lie in one and the same brick of a coarser level, and the end. key_above: from a brick's
/// Morton code to that one's.
template <class KeyAbove>
std::vector<std::size_t> starts_below(const Level& level, const KeyAbove& key_above) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < level.key.size(); ++i)
    if (i == 0 || key_above(level.key[i]) != key_above(level.key[i - 1])) starts.push_back(i);
  starts.push_back(level.key.size());
  return starts;
}

/// i: in the level. Its normal is zero where the level has none.
inline Voxel voxel_at(const Level& level, std::size_t i) {
  Voxel v{};
  for (std::size_t c = 0; c < 4; ++c) v.rgba[c] = level.rgba[4 * i + c];
  for (std::size_t c = 0; c < 2 && !level.normal.empty(); ++c) v.normal[c] = level.normal[2 * i + c];
  return v;
}

}  // namespace gigabake::kernels
