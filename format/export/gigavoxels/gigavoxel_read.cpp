#include "format/export/gigavoxels/gigavoxel_read.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <pugixml.hpp>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "core/io/bytes.h"
#include "format/export/gigavoxels/gigavoxel_files.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

constexpr std::uint32_t max_levels = 16, max_brick_edge = 256;

/// Checks the rules that hold for every tree, independent of its file format.
void check(const std::filesystem::path& file, const GigavoxelHeader& h) {
  if (h.max_depth < 1 || h.max_depth > max_levels) throw InputError(file, "MaxDepth", "expected 1 to 16 levels");
  for (std::size_t c = 0; c < 3; ++c) {
    if (h.brick[c] < 1 || h.brick[c] > max_brick_edge)
      throw InputError(file, fmt::format("Brick{}Size", gigavoxel_axes[c]), "expected 1 to 256 voxels");
    if (std::uint64_t(h.volume[c]) != std::uint64_t(h.brick[c]) << (h.max_depth - 1))
      throw InputError(file, fmt::format("Volume{}Size", gigavoxel_axes[c]),
                       "is not the brick's size times 2^(MaxDepth - 1)");
    if (!std::isfinite(h.corner_m[c]) || !(h.delta_m[c] > 0) || !std::isfinite(h.delta_m[c]))
      throw InputError(file, fmt::format("Delta{}", gigavoxel_axes[c]),
                       "expected finite positions and voxels of positive size");
  }
}

/// Converter of XML elements to nodes, depth first.
class XmlTree {
 public:
  explicit XmlTree(const std::filesystem::path& file) : file_(file) {}

  GigavoxelTree read(pugi::xml_node root) {
    read_header(root);
    tree_.nodes.resize(8);
    const pugi::xml_node first = first_node(root.first_child());
    if (!first) fail(root, "GigaVoxelsNode", "is missing");
    read_node(first, 0, 0);
    return std::move(tree_);
  }

 private:
  /// Returns the first node element among `n` and its next siblings. Returns a null element if there is none.
  static pugi::xml_node first_node(pugi::xml_node n) {
    const auto is_node = [&] {
      const std::string_view name = n.name();
      return name == "GigaVoxelsNode" || name == "Node";
    };
    while (n && !is_node()) n = n.next_sibling();
    return n;
  }

  void read_header(pugi::xml_node root) {
    GigavoxelHeader& h = tree_.header;
    h.max_depth = number<std::uint32_t>(root, "MaxDepth");
    for (std::size_t c = 0; c < 3; ++c) {
      const std::string axis = gigavoxel_axes[c];
      h.corner_m[c] = number<double>(root, axis);
      h.delta_m[c] = number<double>(root, "Delta" + axis);
      h.volume[c] = number<std::uint32_t>(root, "Volume" + axis + "Size");
      h.brick[c] = number<std::uint32_t>(root, "Brick" + axis + "Size");
    }
    check(file_, h);
    if (root.attribute("Compressed").value() == std::string_view("YES"))
      fail(root, "Compressed", "S3TC bricks cannot be read; expected NO");
  }

  void read_node(pugi::xml_node element, std::size_t n, std::uint32_t depth) {
    if (number<std::uint32_t>(element, "Depth") != depth)
      fail(element, "Depth", "is not the element's depth in the tree");
    const std::string_view type = element.attribute("Type").value();
    GigavoxelNode& node = tree_.nodes[n];
    node.is_constant = type != "NON-CONST";
    if (!node.is_constant)
      node.value = number<std::uint32_t>(element, "Brick");
    else if (type == "CONST" || type == "LEAF-CONST")
      read_constant(element, node);
    else
      fail(element, "Type", "expected NON-CONST, CONST or LEAF-CONST");
    if (depth + 1 < tree_.header.max_depth && type != "LEAF-CONST") read_children(element, n, depth + 1);
  }

  void read_constant(pugi::xml_node element, GigavoxelNode& node) {
    for (unsigned c = 0; c < 4; ++c) {
      const double share = number<double>(element, std::string("Color") + "RGBA"[c]);
      if (!(share >= 0 && share <= 1.001)) fail(element, "ColorR", "expected fractions from 0 to 1");
      node.value |= std::min(255u, std::uint32_t(share * 255 + 0.5)) << (8 * c);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::string key = std::string("Gradient") + gigavoxel_axes[c];
      if (element.attribute(key.c_str())) node.gradient[c] = number<std::uint8_t>(element, key);
    }
  }

  void read_children(pugi::xml_node element, std::size_t n, std::uint32_t depth) {
    const std::size_t block = tree_.nodes.size() / 8;
    tree_.nodes[n].child_block = std::uint32_t(block);
    tree_.nodes.resize(tree_.nodes.size() + 8);
    pugi::xml_node child = first_node(element.first_child());
    for (std::size_t c = 0; c < 8; ++c, child = first_node(child.next_sibling())) {
      if (!child) fail(element, "GigaVoxelsNode", "expected eight children");
      read_node(child, 8 * block + c, depth);
    }
    if (child) fail(element, "GigaVoxelsNode", "expected eight children");
  }

  template <class T>
  T number(pugi::xml_node element, const std::string& key) const {
    const pugi::xml_attribute attribute = element.attribute(key.c_str());
    if (!attribute) fail(element, key, "is missing");
    const std::string_view text = attribute.value();
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      fail(element, key, "expected a number, got " + in_quotes(text));
    return value;
  }

  [[noreturn]] void fail(pugi::xml_node element, const std::string& key, const std::string& message) const {
    throw InputError(file_, std::string(element.name()) + " " + key, message, std::uint64_t(element.offset_debug()));
  }

  const std::filesystem::path& file_;
  GigavoxelTree tree_;
};

constexpr std::size_t header_bytes = 8 + 4 + 4 + 2 * 24 + 2 * 12 + 4 + 4;

/// Checks that every block except the first consists of the children of exactly one node in an earlier block.
void check_blocks(const std::filesystem::path& file, const GigavoxelTree& tree) {
  const std::size_t blocks = tree.nodes.size() / 8;
  std::vector<std::uint8_t> depth(blocks, 0);
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    const std::uint64_t byte = header_bytes + 8 * n;
    const std::size_t child = tree.nodes[n].child_block, own = n / 8;
    if (n % 8 == 0 && own > 0 && depth[own] == 0) throw InputError(file, "", "no node refers to this block", byte);
    if (child == 0) continue;
    if (own == 0 && n > 0) throw InputError(file, "", "only the first node of the first block is in use", byte);
    if (child <= own || child >= blocks || depth[child] != 0)
      throw InputError(file, "", "a node's children are not in a later block that no other node refers to", byte);
    depth[child] = std::uint8_t(depth[own] + 1);
    if (depth[child] >= tree.header.max_depth) throw InputError(file, "", "the tree is deeper than MaxDepth", byte);
  }
}

GigavoxelTree read_binary(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  const std::string name = file.string();
  ByteReader in(bytes, name.c_str());
  GigavoxelTree tree;
  std::array<char, 8> magic{};
  std::uint32_t version = 0, compressed = 0, blocks = 0;
  in.get(magic);
  in.get(version);
  if (version != gigavoxel_version) throw InputError(file, "version", "expected 1", 8);
  for_each_header_field(tree.header, [&](auto& field) { in.get(field); });
  in.get(compressed);
  in.get(blocks);
  check(file, tree.header);
  if (compressed != 0) throw InputError(file, "compressed", "S3TC bricks cannot be read; expected 0");
  if (blocks == 0 || bytes.size() != header_bytes + 96 * std::uint64_t(blocks))
    throw InputError(
        file, "blocks",
        fmt::format("{} not fill the file's {} bytes", pluralize(blocks, "block does", "blocks do"), bytes.size()));
  tree.nodes.resize(8 * std::size_t(blocks));
  for (GigavoxelNode& node : tree.nodes) {
    std::uint32_t word = 0;
    in.get(word);
    in.get(node.value);
    node.is_constant = (word & gigavoxel_constant_flag) != 0;
    node.child_block = word & gigavoxel_block_mask;
  }
  for (GigavoxelNode& node : tree.nodes) {
    std::uint8_t padding = 0;
    in.get(node.gradient);
    in.get(padding);
  }
  check_blocks(file, tree);
  return tree;
}

}  // namespace

GigavoxelTree read_gigavoxel_tree(const std::filesystem::path& tree_file) {
  const std::vector<std::uint8_t> bytes = read_whole_file(tree_file);
  if (bytes.size() >= gigavoxel_magic.size() &&
      std::equal(gigavoxel_magic.begin(), gigavoxel_magic.end(), bytes.begin(),
                 [](char c, std::uint8_t byte) { return std::uint8_t(c) == byte; }))
    return read_binary(tree_file, bytes);
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(bytes.data(), bytes.size());
  if (!result)
    throw InputError(tree_file, "", std::string("not an oct-tree: ") + result.description(),
                     std::uint64_t(result.offset));
  const pugi::xml_node root = document.child("GigaVoxelsOctTree");
  if (!root) throw InputError(tree_file, "GigaVoxelsOctTree", "is missing");
  return XmlTree(tree_file).read(root);
}

std::vector<std::filesystem::path> gigavoxel_tree_files(const std::filesystem::path& gvp) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_file(gvp.c_str());
  pugi::xml_node group = document.child("OctTreeGroup");
  if (!group) group = document.child("OctTrees");
  if (!result || !group) throw InputError(gvp, "OctTreeGroup", "is missing; expected a list of oct-trees");
  std::vector<std::filesystem::path> files;
  for (const pugi::xml_node tree : group.children()) {
    const std::string_view name = tree.name();
    if (name != "PagedOctTree" && name != "OctTree") continue;
    const std::filesystem::path file = std::filesystem::path(tree.attribute("TreeFile").value()).lexically_normal();
    if (file.empty() || file.is_absolute() || *file.begin() == "..")
      throw InputError(gvp, "TreeFile", "expected a path inside the folder", std::uint64_t(tree.offset_debug()));
    files.push_back(gvp.parent_path() / file);
  }
  return files;
}

}  // namespace gigabake
