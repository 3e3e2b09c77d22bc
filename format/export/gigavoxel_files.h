/// The files of a GigaVoxels scene, byte by byte.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "format/export/gigavoxel_tree.h"
#include "format/system/output_file.h"

namespace gigabake {

/// As GigaVoxelsOctTree with nested GigaVoxelsNode elements, depth first.
void write_gigavoxel_xml(OutputFile& out, const GigavoxelTree& tree);

/// As attributes of both XML files end, in the order of coordinates.
inline constexpr std::array<const char*, 3> gigavoxel_axes{"X", "Y", "Z"};

inline constexpr std::array<char, 8> gigavoxel_magic{'G', 'V', 'O', 'C', 'T', 'R', 'E', 'E'};
inline constexpr std::uint32_t gigavoxel_version = 1;
/// First word of a node: constant or not, and its children's block.
inline constexpr std::uint32_t gigavoxel_constant_flag = 1u << 30, gigavoxel_block_mask = gigavoxel_constant_flag - 1;

/// The header's fields in the order of a binary file; `field` puts or gets one.
template <class Header, class Field>
void for_each_header_field(Header& header, const Field& field) {
  field(header.max_depth);
  field(header.corner_m);
  field(header.delta_m);
  field(header.volume);
  field(header.brick);
}

/// Header, blocks of eight nodes of two words each, gradients of constant nodes.
void write_gigavoxel_binary(OutputFile& out, const GigavoxelTree& tree);

/// A brick with its border, x fastest.
struct GigavoxelBrick {
  static constexpr std::size_t border = 1, edge = std::size_t(brick_edge) + 2 * border, voxels = edge * edge * edge;
  std::array<std::array<std::uint8_t, 4>, voxels> rgba;
  std::array<GradientBytes, voxels> gradient;
};

/// The first bytes of a brick file.
void begin_gigavoxel_bricks(OutputFile& out);
void write_gigavoxel_brick(OutputFile& out, const GigavoxelBrick& brick);

/// "voxels_3.gvb"
std::string gigavoxel_brick_file(std::size_t depth);

}  // namespace gigabake
