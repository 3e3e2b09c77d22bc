#include "format/export/implicit_octree.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

namespace gigabake {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// A row of bits, and how many of them are set.
struct Bits {
  explicit Bits(std::size_t size) : bytes((size + 7) / 8, '\0') {}
  void set(std::size_t i) {
    bytes[i / 8] = char(std::uint8_t(bytes[i / 8]) | 1u << (i % 8));
    ++count;
  }
  std::string bytes;
  std::uint64_t count = 0;
};

/// Sets bit `first + i` for each tile of `keys` that is the i-th of those 8^down below `root`.
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

std::string subtree_file(const TileLevels& tiles, std::uint32_t level, std::uint64_t root) {
  std::size_t inside = 0;
  for (std::uint32_t down = 0; down < subtree_levels; ++down) inside += std::size_t(1) << (3 * down);
  Bits available(inside), children(std::size_t(1) << (3 * subtree_levels));
  std::size_t first = 0;
  for (std::uint32_t down = 0; down < subtree_levels; first += std::size_t(1) << (3 * down), ++down)
    if (level + down < tiles.size()) set_below(tiles[level + down], root, down, first, available);
  if (level + subtree_levels < tiles.size())
    set_below(tiles[level + subtree_levels], root, subtree_levels, 0, children);

  const OrderedJson bits = {{"bitstream", 0}, {"availableCount", available.count}};
  OrderedJson json = {
      {"buffers", OrderedJson::array()},
      {"bufferViews", OrderedJson::array({{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", available.bytes.size()}}})},
      {"tileAvailability", bits},
      {"contentAvailability", OrderedJson::array({bits})},
      {"childSubtreeAvailability", {{"constant", 0}}}};
  std::string binary = padded(available.bytes, '\0');
  if (children.count > 0) {
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", children.bytes.size()}});
    json["childSubtreeAvailability"] = {{"bitstream", 1}, {"availableCount", children.count}};
    binary += children.bytes;
  }
  json["buffers"].push_back({{"byteLength", binary.size()}});
  const std::string text = padded(json.dump(), ' ');
  std::string file = "subt";
  append(file, 1, 4);
  append(file, text.size(), 8);
  append(file, binary.size(), 8);
  return file + text + binary;
}

}  // namespace gigabake
