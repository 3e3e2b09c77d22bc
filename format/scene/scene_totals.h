/// Sums over the cells and overviews of a scene or of one of its pages.
#pragma once

#include <cstdint>
#include <vector>

#include "format/scene/cell_window.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Sums of the values that cells and overviews record. Vectors are per lod of the lattice, up to the highest of any
/// shard.
struct SceneTotals {
  SceneTotals() = default;
  explicit SceneTotals(const std::vector<SceneCell>& cells);
  explicit SceneTotals(const SceneDescription& scene);

  void add(const SceneCell& cell);
  void add(const SceneTotals& part);
  Hash128 all_content() const;  ///< of all lods
  bool has_stored() const { return cells + overviews == 0 || !level_bytes.empty(); }
  friend bool operator==(const SceneTotals&, const SceneTotals&) = default;

  std::uint64_t cells = 0, overviews = 0, bytes = 0;
  std::vector<std::uint64_t> voxels;
  std::vector<Hash128> content_hash;
  std::vector<std::uint64_t> level_bytes;  ///< empty if a cell or an overview lacks it
  std::uint64_t node_bytes = 0;            ///< 0 if a cell or an overview lacks it
  std::uint32_t cell_voxels = 0;           ///< of all cells; 0 if cells have several sizes
  LatticeBox window;                       ///< of all cells; empty if there are none
};

}  // namespace gigabake
