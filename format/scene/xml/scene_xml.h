/// The list of a scene's shards and their positions. scene.xml has the thesis's schema with additional attributes
/// (docs/format.md).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "core/math/box3.h"
#include "core/math/frames.h"
#include "format/shard/shard.h"

namespace gigabake {

/// One cell or one overview in a scene's list.
struct SceneCell {
  std::string name;
  std::string file;  ///< shard, relative to the scene.xml
  Vec3i64 lattice_min{};
  std::uint32_t cell_voxels = 0;
  std::uint32_t lods = 0;
  std::uint64_t bytes = 0;
  std::uint64_t triangles = 0;
  std::vector<std::uint64_t> voxels;  ///< per lod
  Hash128 fingerprint;
  std::vector<Hash128> content_hash;            ///< per lod
  std::vector<std::uint64_t> level_bytes = {};  ///< compressed size of each lod, a part of `bytes`; empty: not recorded
  std::uint64_t node_bytes = 0;                 ///< compressed size of the nodes; recorded together with level_bytes
  std::uint32_t first_lod = 0;                  ///< lattice level of the shard's level 0. 0: a cell; else an overview
  std::uint32_t copied_lods = 0;                ///< number of finest levels that duplicate the children's; overviews
                                                ///< only

  /// Returns the finest native level on the lattice. Sums over a scene start at this level, so that duplicated levels
  /// count once.
  std::uint32_t own_lod() const { return first_lod + copied_lods; }
  /// Returns the number of voxels on native levels.
  std::uint64_t own_voxels() const {
    return std::accumulate(voxels.begin() + std::min<std::ptrdiff_t>(copied_lods, std::ssize(voxels)), voxels.end(),
                           std::uint64_t(0));
  }
};

/// Returns the cube of the lattice that a cell covers, in lod-0 voxels.
inline Box3i64 window_of(const SceneCell& cell) { return Box3i64::cube(cell.lattice_min, cell.cell_voxels); }

/// An input, cell or overview that the bake could not process.
struct SceneLoss {
  std::string name, reason;
};

/// The levels of all overviews of one size, which form an overview level. The windows of these overviews are aligned to
/// their edge. The window of the root, the only overview of its level, is aligned to half its edge.
struct TierShape {
  std::uint32_t first_lod = 0, copied_lods = 0, lods = 0;  ///< see SceneCell

  std::uint32_t own_lod() const { return first_lod + copied_lods; }
  std::uint32_t end_lod() const { return first_lod + lods; }
  /// Returns log2 of a window's edge in voxels of lod 0.
  int window_bits() const { return int(end_lod()) + 2; }
  friend bool operator==(const TierShape&, const TierShape&) = default;
};

/// The content of scene.xml that does not depend on the number of cells.
struct SceneHeader {
  std::string generator;
  double voxel_size_m = 0;
  Vec3d lattice_origin_m{};
  std::optional<Geodetic> origin;
  bool has_normals = true;
  bool has_directional_coverage = false;
  bool has_classes = false;  ///< voxels have classes
  std::string parameters;    ///< the bake's parameters as one line of JSON
  /// Coarsest level that may have leaves: voxels that describe all finer levels. 0: there are none.
  std::uint32_t leaf_lod = 0;
  Box3i64 bounds;  ///< lod-0 voxels that contain all surfaces of the sources; empty: not recorded
  std::uint64_t triangles = 0, non_finite = 0, zero_area = 0, skipped_points = 0, skipped_lines = 0;
  std::vector<SceneLoss> losses;
  /// The overview levels (tier_shape.h); empty unless all cells have one root and scene.xml lists the levels.
  /// write_scene() derives the levels from the overviews instead.
  std::vector<TierShape> tiers;
};

/// A scene with all its cells in memory, about 700 bytes each. Use PagedScene to visit cell by cell.
struct SceneDescription : SceneHeader {
  std::vector<SceneCell> cells;      ///< sorted by lattice_min z, y, x
  std::vector<SceneCell> overviews;  ///< overviews, each after its children
};

/// Rule for splitting a scene into pages; bakes use the defaults.
struct PageRule {
  std::size_t max_cells_per_file = 4096;  ///< a scene with more cells has pages
  /// The number of cells along an edge of the smallest blocks, and of smaller blocks along an edge of each larger
  /// block. A power of two from 2.
  std::uint32_t block_cells = 16;
  std::size_t max_groups_per_file = 256;  ///< max page references in scene.xml
};

/// Writes the new pages, then replaces `path` atomically (temporary file, fsync, rename, fsync folder). Previous pages
/// remain; call remove_unused_pages(). A scene whose cells have several sizes has no pages.
void write_scene(const std::filesystem::path& path, const SceneDescription& scene, const PageRule& rule = {});
/// Reads the scene with all its cells, including cells of pages.
/// Errors  The errors of read_scene_text(). InputError if a page is missing or does not match its reference, or if
///         totals do not match the cells.
SceneDescription read_scene(const std::filesystem::path& path);

}  // namespace gigabake
