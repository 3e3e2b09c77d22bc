/// A scene of one cell for tests of rays. The test fills its pools.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/marching/scene.h"

namespace gigabake::kernels {

struct OneCell {
  std::vector<CastCell> cells{{{0, 0, 0}}};
  std::vector<std::uint64_t> column_key{0};
  std::vector<std::uint32_t> column_first{0, 1};
  CastScene scene;

  /// Makes a scene of one cell whose edge is 2^cell_bits voxels.
  OneCell(int cell_bits, int lods) {
    scene.cells = {cells.data(), cells.size()};
    scene.column_key = {column_key.data(), column_key.size()};
    scene.column_first = {column_first.data(), column_first.size()};
    scene.column_count[0] = scene.column_count[1] = 1;
    scene.cell_bits = cell_bits;
    scene.lods = lods;
    for (double& side : scene.max) side = double(1 << cell_bits);
    scene.set_corner();
  }
  OneCell(const OneCell&) = delete;
  OneCell& operator=(const OneCell&) = delete;
};

}  // namespace gigabake::kernels
