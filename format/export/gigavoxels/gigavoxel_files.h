/// Writing of a GigaVoxels scene's files.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "format/export/gigavoxels/gigavoxel_tree.h"
#include "format/system/output_file.h"

namespace gigabake {

/// Writes a GigaVoxelsOctTree with nested GigaVoxelsNode elements, depth first.
void write_gigavoxel_xml(OutputFile& out, const GigavoxelTree& tree);

/// Suffixes of attribute names in both XML files, in the order of coordinates.
inline constexpr std::array<const char*, 3> gigavoxel_axes{"X", "Y", "Z"};

inline constexpr std::array<char, 8> gigavoxel_magic{'G', 'V', 'O', 'C', 'T', 'R', 'E', 'E'};
inline constexpr std::uint32_t gigavoxel_version = 1;
/// Bits in the first word of a node: the constant flag, and the number of the block of its children.
inline constexpr std::uint32_t gigavoxel_constant_flag = 1u << 30, gigavoxel_block_mask = gigavoxel_constant_flag - 1;

/// Calls field(member) for each header field, in the order of a binary file.
template <class Header, class Field>
void for_each_header_field(Header& header, const Field& field) {
  field(header.max_depth);
  field(header.corner_m);
  field(header.delta_m);
  field(header.volume);
  field(header.brick);
}

/// Writes the header, all nodes (two words each), and then the gradients of all nodes.
void write_gigavoxel_binary(OutputFile& out, const GigavoxelTree& tree);

/// A brick with its border; x varies fastest.
struct GigavoxelBrick {
  static constexpr std::size_t border = 1, edge = std::size_t(brick_edge) + 2 * border, voxels = edge * edge * edge;
  std::array<std::array<std::uint8_t, 4>, voxels> rgba;
  std::array<GradientBytes, voxels> gradient;
};

/// Writes the header of a brick file, which declares uncompressed bricks.
void begin_gigavoxel_bricks(OutputFile& out);
void write_gigavoxel_brick(OutputFile& out, const GigavoxelBrick& brick);

/// Returns the name of the brick file of a depth, such as "voxels_3.gvb".
std::string gigavoxel_brick_file(std::size_t depth);

}  // namespace gigabake
