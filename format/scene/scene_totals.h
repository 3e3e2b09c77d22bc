/// Sums over cells and parents: of a scene, or of one of its pages.
#pragma once

#include <cstdint>
#include <vector>

#include "format/scene/cell_window.h"
#include "format/scene/scene_xml.h"

namespace gigabake {

/// What the cells and parents say of themselves. Per lod of the lattice, up to the highest that any of them has.
struct SceneTotals {
  SceneTotals() = default;
  explicit SceneTotals(const std::vector<SceneCell>& cells);
  explicit SceneTotals(const SceneDescription& scene);

  void add(const SceneCell& cell);
  void add(const SceneTotals& part);
  Hash128 all_content() const;  ///< of all lods
  bool has_stored() const { return cells + parents == 0 || !level_bytes.empty(); }
  friend bool operator==(const SceneTotals&, const SceneTotals&) = default;

  std::uint64_t cells = 0, parents = 0, bytes = 0;
  std::vector<std::uint64_t> voxels;
  std::vector<Hash128> content_hash;
  std::vector<std::uint64_t> level_bytes;  ///< empty where a cell or a parent lacks it
  std::uint64_t node_bytes = 0;            ///< 0 where one lacks it
  std::uint32_t cell_voxels = 0;           ///< of all cells; 0 where they have several
  LatticeBox window;                       ///< of all cells; empty where there are none
};

}  // namespace gigabake
