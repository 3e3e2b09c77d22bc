/// One tile of voxel 3D Tiles as a file: a binary glTF.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "format/export/voxel_grid.h"

namespace gigabake {

/// A tile's box in the tileset's frame, without padding.
struct TileBox {
  Vec3d centre_m{};
  double edge_m = 0;
};

/// Returns the schema with class `voxel`, the properties of a voxel. The tileset and each tile contain this schema.
/// `has_classes` adds the property `voxel_class`; `class` is a reserved word of shaders.
nlohmann::ordered_json voxel_schema(bool has_classes);

/// Replaces `file` by a glTF 2.0 with EXT_primitive_voxels.
/// Range   The grid has the order y_up.
void make_voxel_tile(const VoxelGrid& grid, const TileBox& box, std::vector<std::uint8_t>& file);
/// Replaces `file` by a glTF 2.1 with EXT_voxels.
/// Range   The grid has the order right_forward_up.
void make_voxel_node(const VoxelGrid& grid, const TileBox& box, std::vector<std::uint8_t>& file);

/// Converts a point of the tileset's frame (x east, z up) to the frame of glTF 2.1 (x to the left, y up, z forward).
Vec3d in_gltf_2_1(const Vec3d& p);

/// Replaces `file` by a binary glTF with `document` and one buffer, which is the concatenation of `parts_of_buffer`.
void make_glb(const nlohmann::ordered_json& document,
              std::initializer_list<std::span<const std::uint8_t>> parts_of_buffer, std::vector<std::uint8_t>& file);

}  // namespace gigabake
