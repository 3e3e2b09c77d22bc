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
  std::uint32_t available_levels = 1;  ///< of the whole tileset; at most 32
  std::string subtrees_uri;            ///< template

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
/// Errors  InputError: a member that is missing, of another type or out of range.
std::optional<ImplicitTiling> implicit_tiling(const JsonMembers& tile);

/// Replaces {level}, {x}, {y} and {z} in a template URI.
std::string filled_template(const std::string& uri, const TileCoordinates& place);

/// Availability of tiles, contents and child subtrees: one .subtree (binary) or subtree JSON, with external buffers.
class SubtreeAvailability {
 public:
  /// contents: max number per tile.
  /// Errors  InputError: bits or bytes beyond their buffers, versions and members that are not as specified.
  SubtreeAvailability(const SourceFiles& files, const std::filesystem::path& file, const ImplicitTiling& tiling,
                      std::size_t contents);

  bool tile(std::uint64_t index_in_subtree) const { return tiles_.at(index_in_subtree); }
  bool content(std::size_t which, std::uint64_t index_in_subtree) const {
    return which < contents_.size() && contents_[which].at(index_in_subtree);
  }
  /// index: in the level below the subtree's last.
  bool child_subtree(std::uint64_t index_in_level) const { return children_.at(index_in_level); }

 private:
  struct Bits {
    bool constant = false;
    std::vector<std::uint8_t> bytes;  ///< least significant bit first; empty: all are `constant`
    bool at(std::uint64_t i) const { return bytes.empty() ? constant : (bytes[i / 8] >> (i % 8) & 1) != 0; }
  };
  class Reader;

  Bits tiles_, children_;
  std::vector<Bits> contents_;
};

}  // namespace gigabake
