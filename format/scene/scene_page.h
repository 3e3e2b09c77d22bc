/// A page of a scene: the file of one group, which lists cells or refers to smaller pages (docs/format.md, "Pages").
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/math/box3.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Sums over the cells and overviews of a scene or of one of its pages. Vectors are per lod of the lattice, up to the
/// highest lod of any shard.
struct SceneTotals {
  SceneTotals() = default;
  explicit SceneTotals(const std::vector<SceneCell>& cells);
  explicit SceneTotals(const SceneDescription& scene);

  void add(const SceneCell& cell);
  void add(const SceneTotals& part);
  Hash128 all_content() const;  ///< content hash of all lods
  bool has_stored() const { return cells + overviews == 0 || !level_bytes.empty(); }
  friend bool operator==(const SceneTotals&, const SceneTotals&) = default;

  std::uint64_t cells = 0, overviews = 0, bytes = 0;
  std::vector<std::uint64_t> voxels;
  std::vector<Hash128> content_hash;
  std::vector<std::uint64_t> level_bytes;  ///< empty if a cell or an overview lacks it
  std::uint64_t node_bytes = 0;            ///< 0 if a cell or an overview lacks it
  std::uint32_t cell_voxels = 0;           ///< edge of all cells; 0 if cells have several sizes
  Box3i64 window;                          ///< bounding box of all cells; empty if there are none
};

/// The lattice cube of a page.
/// Range   `edge` is a power of two, and `min` is a multiple of `edge`.
struct LatticeBlock {
  Vec3i64 min{};
  std::int64_t edge = 0;

  Box3i64 box() const { return Box3i64::cube(min, edge); }
  friend bool operator==(const LatticeBlock&, const LatticeBlock&) = default;
};

/// Returns the block with this edge that contains `voxel`.
LatticeBlock block_around(const Vec3i64& voxel, std::int64_t edge);
/// Returns whether the shard's whole window lies in the block. At most one block of a group contains the window.
bool lies_in(const SceneCell& shard, const LatticeBlock& block);

/// A page as described by the group above it.
struct PageReference {
  std::string file;  ///< relative to the scene.xml
  Hash128 checksum;
  LatticeBlock block;
  std::uint64_t groups = 0;  ///< number of pages directly below; 0: the page lists cells
  SceneTotals totals;
};

/// A page's content: cells or pages, not both. Pages are sorted by z, y, x of their blocks, cells by z, y, x of
/// lattice_min.
struct ScenePage {
  std::vector<SceneCell> cells;
  std::vector<PageReference> pages;
  /// An overview is in the smallest page whose block contains it. Pages before version 5 have no overviews.
  std::vector<SceneCell> overviews;
};

/// Reads a page of the scene that `header` describes.
/// Errors  InputError: the file is missing or damaged, or is not the page that `reference` describes.
ScenePage read_page(const std::filesystem::path& scene_xml, const SceneHeader& header, const PageReference& reference);

}  // namespace gigabake
