/// Classes of cells by the features that their materials need.
#pragma once

#include <cstdint>

#include "core/base/rules.h"
#include "kernels/body/cell.h"
#include "kernels/body/voxelize/part.h"

namespace gigabake::kernels {

enum class CellMaterials : std::uint8_t {
  plain,   ///< opaque and without textures
  opaque,  ///< opaque; no part has both a texture and vertex colours
  any
};

/// Returns true if every voxel that a triangle overlaps is visible.
constexpr bool all_visible(CellMaterials m) { return m != CellMaterials::any; }

inline CellMaterials materials_in(const CellInput& input) {
  for (std::size_t i = 0; i < input.materials.size; ++i)
    if (input.materials[i].alpha_mode != AlphaMode::opaque) return CellMaterials::any;
  CellMaterials found = CellMaterials::plain;
  for (std::size_t i = 0; i < input.parts.size; ++i) {
    if (!is_textured(input, input.parts[i])) continue;
    if (!input.parts[i].rgba.empty()) return CellMaterials::any;
    found = CellMaterials::opaque;
  }
  return found;
}

}  // namespace gigabake::kernels
