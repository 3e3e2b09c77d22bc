/// A page of a scene: the file of one group, which lists cells or refers to smaller pages (docs/format.md, "Pages").
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/scene/scene_totals.h"
#include "format/scene/scene_xml.h"
#include "lattice/error.h"

namespace gigabake {

/// A cube of the lattice that a page is of. Range  edge is a power of two, min a multiple of it.
struct LatticeBlock {
  std::array<std::int64_t, 3> min{};
  std::int64_t edge = 0;

  LatticeBox box() const { return {min, {min[0] + edge, min[1] + edge, min[2] + edge}}; }
  friend bool operator==(const LatticeBlock&, const LatticeBlock&) = default;
};

/// The block of that edge that holds a voxel.
LatticeBlock block_around(const std::array<std::int64_t, 3>& voxel, std::int64_t edge);
/// With all of its window. No two blocks of a group do.
bool lies_in(const SceneCell& shard, const LatticeBlock& block);

/// What the group above says of a page.
struct PageReference {
  std::string file;  ///< relative to the scene.xml
  Hash128 checksum;
  LatticeBlock block;
  std::uint64_t groups = 0;  ///< pages right below it; 0: it lists cells
  SceneTotals totals;
};

/// Cells or pages, not both. The latter are sorted by their block's z, y, x, cells by their lattice_min's.
struct ScenePage {
  std::vector<SceneCell> cells;
  std::vector<PageReference> pages;
  std::vector<SceneCell> parents;  ///< each in the smallest page whose block it lies in, and before version 5 in none
};

/// Errors  InputError: a file that is missing or damaged, or is not the page that `reference` means; `header` of the
///         scene that it should be of.
ScenePage read_page(const std::filesystem::path& scene_xml, const SceneHeader& header, const PageReference& reference);

}  // namespace gigabake
