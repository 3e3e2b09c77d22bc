/// The paged scene: which shards there are and where (scene.xml, the thesis's schema with our attributes;
/// docs/format.md).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "format/shard/shard.h"
#include "lattice/frames.h"

namespace gigabake {

/// One cell, or one parent, as the scene lists it.
struct SceneCell {
  std::string name;
  std::string file;  ///< shard, relative to the scene.xml
  std::array<std::int64_t, 3> lattice_min{};
  std::uint32_t cell_voxels = 0;
  std::uint32_t lods = 0;
  std::uint64_t bytes = 0;
  std::uint64_t triangles = 0;
  std::vector<std::uint64_t> voxels;  ///< per lod
  Hash128 fingerprint;
  std::vector<Hash128> content_hash;            ///< per lod
  std::vector<std::uint64_t> level_bytes = {};  ///< of `bytes`, per lod, as stored; empty: nobody wrote it down
  std::uint64_t node_bytes = 0;                 ///< with level_bytes
  std::uint32_t first_lod = 0;                  ///< of the lattice: its own level 0. 0: a cell; else a parent
  std::uint32_t copied_lods = 0;                ///< of a parent: its finest levels, which are copies of its children's

  /// Of the lattice: the finest level that is nobody else's. What is counted over a scene begins here.
  std::uint32_t own_lod() const { return first_lod + copied_lods; }
  /// Of its own levels together.
  std::uint64_t own_voxels() const {
    return std::accumulate(voxels.begin() + std::min<std::ptrdiff_t>(copied_lods, std::ssize(voxels)), voxels.end(),
                           std::uint64_t(0));
  }
};

/// Anything the bake was asked for and could not deliver.
struct SceneLoss {
  std::string name, reason;
};

/// The levels of all parents of one size. Their windows are multiples of their edge; the root's, which is the only one
/// of its tier, of half of it.
struct TierShape {
  std::uint32_t first_lod = 0, copied_lods = 0, lods = 0;  ///< as SceneCell

  std::uint32_t own_lod() const { return first_lod + copied_lods; }
  std::uint32_t end_lod() const { return first_lod + lods; }
  /// A window's edge is 2^bits voxels of lod 0.
  int window_bits() const { return int(end_lod()) + 2; }
  friend bool operator==(const TierShape&, const TierShape&) = default;
};

/// What scene.xml says itself, however many cells a scene has.
struct SceneHeader {
  std::string generator;
  double voxel_size_m = 0;
  std::array<double, 3> lattice_origin_m{};
  std::optional<Geodetic> origin;
  bool has_normals = true;
  bool has_facing = false;
  std::string parameters;  ///< the bake's parameters as one line of JSON
  std::uint64_t triangles = 0, non_finite = 0, zero_area = 0, skipped_points = 0, skipped_lines = 0;
  std::vector<SceneLoss> losses;
  std::vector<TierShape> tiers;  ///< where all hangs from one root and scene.xml says so (tier_shape.h); write_scene()
                                 ///< looks at the parents instead
};

/// A scene with all its cells in memory, some 700 bytes each. Who goes from cell to cell takes a PagedScene.
struct SceneDescription : SceneHeader {
  std::vector<SceneCell> cells;    ///< sorted by lattice_min z, y, x
  std::vector<SceneCell> parents;  ///< of the levels above the cells', each after its children
};

/// Where a scene gets pages; the defaults are what bakes write.
struct PageRule {
  std::size_t most_cells_of_a_file = 4096;  ///< a scene of more has pages
  std::uint32_t block_cells = 16;  ///< along an edge of a finest block, as blocks along that of the next; 2, 4, 8, …
  std::size_t most_groups_of_a_file = 256;  ///< of scene.xml
};

/// Writes the pages, which the scene of before does not know, then replaces `path` atomically (write aside, fsync,
/// rename, fsync folder). Pages of before stay: remove_unused_pages(). A scene whose cells have several sizes has no
/// pages.
void write_scene(const std::filesystem::path& path, const SceneDescription& scene, const PageRule& rule = {});
/// All cells, those of pages too.
/// Errors  InputError: not XML, unknown version, missing or malformed attribute, shard paths leaving the folder, a page
///         that is missing or not the one that is meant, totals that are not those of the cells.
SceneDescription read_scene(const std::filesystem::path& path);

}  // namespace gigabake
