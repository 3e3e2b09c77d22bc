#include "format/export/voxel_tiles/implicit_octree.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "format/export/voxel_tiles/voxel_tile.h"

namespace gigabake {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// A bit array and the number of its set bits.
struct Bits {
  explicit Bits(std::size_t size) : bytes((size + 7) / 8, '\0') {}
  void set(std::size_t i) {
    bytes[i / 8] = char(std::uint8_t(bytes[i / 8]) | 1u << (i % 8));
    ++count;
  }
  std::string bytes;
  std::uint64_t count = 0;
};

/// Sets bit first + i for each tile in `keys` that is descendant i of `root`. The 8^down descendants are `down` levels
/// below `root`.
void set_below(const std::vector<std::uint64_t>& keys, std::uint64_t root, std::uint32_t down, std::size_t first,
               Bits& bits) {
  const std::uint64_t begin = root << (3 * down), end = (root + 1) << (3 * down);
  for (auto key = std::lower_bound(keys.begin(), keys.end(), begin); key != keys.end() && *key < end; ++key)
    bits.set(first + std::size_t(*key - begin));
}

std::string padded(std::string text, char with) {
  text.resize((text.size() + 7) / 8 * 8, with);
  return text;
}

void append(std::string& to, std::uint64_t value, std::size_t bytes) {
  char text[8];
  std::memcpy(text, &value, 8);
  to.append(text, bytes);
}

}  // namespace

std::uint32_t subtree_levels(std::uint32_t levels) {
  constexpr std::uint32_t maximum = 6;
  const std::uint32_t files = (levels + maximum - 1) / maximum;  // number of subtrees on a path from the root
  return (levels + files - 1) / files;
}

namespace {

/// The available tiles of a subtree, and its available child subtrees.
struct Availability {
  Bits tiles, children;

  Availability(const TileLevels& levels, std::uint32_t level, std::uint64_t root, std::uint32_t own)
      : tiles(tiles_of(own)), children(std::size_t(1) << (3 * own)) {
    std::size_t first = 0;
    for (std::uint32_t down = 0; down < own; first += std::size_t(1) << (3 * down), ++down)
      if (level + down < levels.size()) set_below(levels[level + down], root, down, first, tiles);
    if (level + own < levels.size()) set_below(levels[level + own], root, own, 0, children);
  }

  static std::size_t tiles_of(std::uint32_t own) {
    std::size_t inside = 0;
    for (std::uint32_t down = 0; down < own; ++down) inside += std::size_t(1) << (3 * down);
    return inside;
  }

  /// Returns the bits of the tiles, followed by the bits of the child subtrees if any of them is set.
  std::string binary() const {
    return padded(tiles.bytes, '\0') + (children.count > 0 ? children.bytes : std::string());
  }
  OrderedJson views() const {
    OrderedJson views = OrderedJson::array({{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", tiles.bytes.size()}}});
    if (children.count > 0)
      views.push_back(
          {{"buffer", 0}, {"byteOffset", (tiles.bytes.size() + 7) / 8 * 8}, {"byteLength", children.bytes.size()}});
    return views;
  }
  OrderedJson of_tiles() const { return {{"bitstream", 0}, {"availableCount", tiles.count}}; }
  OrderedJson of_children() const {
    if (children.count == 0) return {{"constant", 0}};
    return {{"bitstream", 1}, {"availableCount", children.count}};
  }
};

}  // namespace

std::string subtree_file(const TileLevels& tiles, std::uint32_t level, std::uint64_t root) {
  const Availability available(tiles, level, root, subtree_levels(std::uint32_t(tiles.size())));
  const std::string binary = available.binary();
  const OrderedJson json = {{"buffers", OrderedJson::array({{{"byteLength", binary.size()}}})},
                            {"bufferViews", available.views()},
                            {"tileAvailability", available.of_tiles()},
                            {"contentAvailability", OrderedJson::array({available.of_tiles()})},
                            {"childSubtreeAvailability", available.of_children()}};
  const std::string text = padded(json.dump(), ' ');
  std::string file = "subt";
  append(file, 1, 4);
  append(file, text.size(), 8);
  append(file, binary.size(), 8);
  return file + text + binary;
}

std::vector<std::uint8_t> subtree_glb(const TileLevels& tiles, std::uint32_t level, std::uint64_t root) {
  const Availability available(tiles, level, root, subtree_levels(std::uint32_t(tiles.size())));
  const std::string binary = available.binary();
  const std::vector<std::string> extensions{"3DTILES_subtree"};
  const OrderedJson subtree = {{"tileAvailability", available.of_tiles()},
                               {"contentAvailability", available.of_tiles()},
                               {"childSubtreeAvailability", available.of_children()}};
  const OrderedJson document = {
      {"asset", {{"version", "2.1"}}},    {"extensionsUsed", extensions},
      {"extensionsRequired", extensions}, {"buffers", OrderedJson::array({{{"byteLength", binary.size()}}})},
      {"bufferViews", available.views()}, {"extensions", {{"3DTILES_subtree", subtree}}}};
  std::vector<std::uint8_t> file;
  make_glb(document, {{reinterpret_cast<const std::uint8_t*>(binary.data()), binary.size()}}, file);
  return file;
}

}  // namespace gigabake
