/// 3D Tiles 1.1 "Implicit Tiling", and the extension 3DTILES_implicit_tiling of 1.0. Implicit tiles are not listed:
/// they follow from a subdivision and from bits that state which tiles exist.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/source/source_file.h"
#include "format/source/source_files.h"
#include "format/system/json/json_members.h"

namespace gigabake {

struct TileCoordinates {
  std::uint32_t level = 0;
  std::uint64_t x = 0, y = 0, z = 0;
  /// Returns a child. Children are in Morton order: bit 0 of `i` is x, bit 1 is y, bit 2 is z (0 in a quadtree).
  TileCoordinates child(int i) const {
    return {level + 1, 2 * x + std::uint64_t(i & 1), 2 * y + std::uint64_t(i >> 1 & 1),
            2 * z + std::uint64_t(i >> 2 & 1)};
  }
};

struct ImplicitTiling {
  bool is_octree = false;
  std::uint32_t subtree_levels = 1;    ///< 1 … 10 in an octree, 1 … 15 in a quadtree
  std::uint32_t available_levels = 1;  ///< levels of the whole tileset; at most 32
  std::string subtrees_uri;            ///< template of the URIs of subtree files

  int children() const { return is_octree ? 8 : 4; }
  std::uint64_t tiles_in_level(std::uint32_t level) const { return std::uint64_t(1) << (is_octree ? 3 : 2) * level; }
  std::uint64_t tiles_in_subtree() const {
    return (tiles_in_level(subtree_levels) - 1) / (std::uint64_t(children()) - 1);
  }
  /// Returns the Morton index; `local` is relative to the subtree's root.
  std::uint64_t index_in_level(const TileCoordinates& local) const;
  std::uint64_t index_in_subtree(const TileCoordinates& local) const {
    return (tiles_in_level(local.level) - 1) / (std::uint64_t(children()) - 1) + index_in_level(local);
  }
};

/// Returns the implicit tiling of a tile; nullopt if the tile is explicit.
/// Errors  InputError: a member is missing, has a wrong type, or is out of range.
std::optional<ImplicitTiling> implicit_tiling(const JsonMembers& tile);

/// Replaces {level}, {x}, {y} and {z} in a template URI.
std::string filled_template(const std::string& uri, const TileCoordinates& place);

/// The availability of tiles, contents and child subtrees, read from one subtree file (binary .subtree, or JSON) and
/// its external buffers.
class SubtreeAvailability {
 public:
  /// `contents` is the max number of contents per tile.
  /// Errors  InputError: bits or bytes exceed their buffers, or a version or member violates the specification.
  SubtreeAvailability(const SourceFiles& files, const std::filesystem::path& file, const ImplicitTiling& tiling,
                      std::size_t contents);

  bool tile(std::uint64_t index_in_subtree) const { return tiles_.at(index_in_subtree); }
  bool content(std::size_t which, std::uint64_t index_in_subtree) const {
    return which < contents_.size() && contents_[which].at(index_in_subtree);
  }
  /// Returns whether a child subtree exists. Its root is in the level below the last level of this subtree, at
  /// `index_in_level`.
  bool child_subtree(std::uint64_t index_in_level) const { return children_.at(index_in_level); }
  /// Returns the number of contents of a tile and of the tiles below it in the subtree. Counts a child subtree as one
  /// content. `local` is relative to the subtree's root.
  std::uint64_t contents_below(const ImplicitTiling& tiling, const TileCoordinates& local) const;

 private:
  struct Bits {
    bool constant = false;
    std::vector<std::uint8_t> bytes;  ///< least significant bit first; if empty, all bits are `constant`
    bool at(std::uint64_t i) const { return bytes.empty() ? constant : (bytes[i / 8] >> (i % 8) & 1) != 0; }
  };
  class Reader;

  Bits tiles_, children_;
  std::vector<Bits> contents_;
};

}  // namespace gigabake
