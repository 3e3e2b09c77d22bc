#include "format/export/gigavoxels/gigavoxel_files.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace gigabake {
namespace {

constexpr std::int32_t uncompressed = 0;

/// Returns a colour component in [0, 1] that readers convert back to the same byte, whether they round or truncate.
float share_of(std::uint8_t byte) {
  float share = float(byte) / 255;
  while (share * 255 < float(byte)) share = std::nextafter(share, std::numeric_limits<float>::max());
  return share;
}

template <class Values>
std::string attributes(const char* before, const Values& values, const char* after) {
  std::string text;
  for (std::size_t c = 0; c < 3; ++c)
    text += fmt::format(" {}{}{}=\"{}\"", before, gigavoxel_axes[c], after, values[c]);
  return text;
}

std::string root_element(const GigavoxelHeader& h) {
  return fmt::format("<GigaVoxelsOctTree MaxDepth=\"{}\"", h.max_depth) + attributes("", h.corner_m, "") +
         attributes("Delta", h.delta_m, "") + attributes("Volume", h.volume, "Size") +
         attributes("Brick", h.brick, "Size") + " Binary=\"YES\" Compressed=\"NO\">\n";
}

/// Returns the XML start tag of a node without the closing bracket.
std::string node_element(const GigavoxelNode& node, const Vec3<std::uint32_t>& mip_map, std::uint32_t depth,
                         bool deepest) {
  std::string text = std::string(4 * (depth + 1), ' ') + "<GigaVoxelsNode" + attributes("MipMap", mip_map, "");
  if (!node.is_constant) return text + fmt::format(" Type=\"NON-CONST\" Brick=\"{}\" Depth=\"{}\"", node.value, depth);
  const bool leaf = node.child_block == 0 && !deepest;
  text += leaf ? " Type=\"LEAF-CONST\"" : " Type=\"CONST\"";
  constexpr const char* channels = "RGBA";
  for (int c = 0; c < 4; ++c)
    text += fmt::format(" Color{}=\"{}\"", channels[c], share_of(std::uint8_t(node.value >> (8 * c))));
  return text + fmt::format(" Depth=\"{}\"", depth) + attributes("Gradient", node.gradient, "");
}

void write_node(OutputFile& out, const GigavoxelTree& tree, std::size_t n, const Vec3<std::uint32_t>& mip_map,
                std::uint32_t depth) {
  const GigavoxelNode& node = tree.nodes[n];
  out.write(node_element(node, mip_map, depth, depth + 1 == tree.header.max_depth));
  if (node.child_block == 0) return out.write("/>\n");
  out.write(">\n");
  for (std::uint32_t c = 0; c < 8; ++c) {
    const auto child = [&](int axis) { return 2 * mip_map[axis] + (c >> axis & 1) * tree.header.brick[axis]; };
    write_node(out, tree, 8 * std::size_t(node.child_block) + c, Vec3<std::uint32_t>::by_axis(child), depth + 1);
  }
  out.write(std::string(4 * (depth + 1), ' ') + "</GigaVoxelsNode>\n");
}

}  // namespace

void write_gigavoxel_xml(OutputFile& out, const GigavoxelTree& tree) {
  out.write(root_element(tree.header));
  write_node(out, tree, 0, {0, 0, 0}, 0);
  out.write("</GigaVoxelsOctTree>\n");
}

void write_gigavoxel_binary(OutputFile& out, const GigavoxelTree& tree) {
  out.put(gigavoxel_magic);
  out.put(gigavoxel_version);
  for_each_header_field(tree.header, [&](const auto& field) { out.put(field); });
  out.put(uncompressed);
  out.put(std::uint32_t(tree.nodes.size() / 8));
  for (const GigavoxelNode& node : tree.nodes) {
    out.put(node.child_block | (node.is_constant ? gigavoxel_constant_flag : 0));
    out.put(node.value);
  }
  for (const GigavoxelNode& node : tree.nodes) {
    out.put(node.gradient);
    out.put(std::uint8_t(0));
  }
}

void begin_gigavoxel_bricks(OutputFile& out) { out.put(uncompressed); }

void write_gigavoxel_brick(OutputFile& out, const GigavoxelBrick& brick) {
  for (int axis = 0; axis < 3; ++axis) out.put(std::uint64_t(GigavoxelBrick::edge));
  for (int axis = 0; axis < 3; ++axis) out.put(std::uint32_t(GigavoxelBrick::border));
  out.put(uncompressed);
  out.put(std::uint32_t(sizeof brick.rgba));
  out.put(brick.rgba);
  out.put(uncompressed);
  out.put(std::uint32_t(sizeof brick.gradient));
  out.put(brick.gradient);
}

std::string gigavoxel_brick_file(std::size_t depth) { return fmt::format("voxels_{}.gvb", depth); }

}  // namespace gigabake
