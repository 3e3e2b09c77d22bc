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
  any,
  smooth_opaque,  ///< like `plain` or `opaque`, with vertex normals
  smooth,         ///< like `any`, with vertex normals
  mapped_opaque,  ///< like `smooth_opaque`, with normal maps
  mapped          ///< like `smooth`, with normal maps
};

/// Returns true if every voxel that a triangle overlaps is visible.
constexpr bool all_visible(CellMaterials m) {
  return m != CellMaterials::any && m != CellMaterials::smooth && m != CellMaterials::mapped;
}

constexpr bool has_normal_maps(CellMaterials m) {
  return m == CellMaterials::mapped_opaque || m == CellMaterials::mapped;
}

/// Returns true if normals may vary over a triangle.
constexpr bool has_vertex_normals(CellMaterials m) {
  return m == CellMaterials::smooth_opaque || m == CellMaterials::smooth || has_normal_maps(m);
}

/// Returns the class without regard to vertex normals and normal maps.
inline CellMaterials flat_materials_in(const CellInput& input) {
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

inline CellMaterials materials_in(const CellInput& input) {
  const CellMaterials flat = flat_materials_in(input);
  for (std::size_t i = 0; i < input.parts.size; ++i)
    if (input.parts[i].normal_map.texture >= 0 && !input.parts[i].normal_uv.empty())
      return all_visible(flat) ? CellMaterials::mapped_opaque : CellMaterials::mapped;
  for (std::size_t i = 0; i < input.parts.size; ++i)
    if (!input.parts[i].normal.empty()) return all_visible(flat) ? CellMaterials::smooth_opaque : CellMaterials::smooth;
  return flat;
}

}  // namespace gigabake::kernels
