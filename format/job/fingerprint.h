/// The key of a cell's result: a hash of all its inputs.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/octree/parameters.h"
#include "format/area/area_in_scene.h"
#include "format/edit/edits_in_scene.h"
#include "format/edit/source_edits_in_scene.h"
#include "format/job/cell_job.h"
#include "format/source/source.h"

namespace gigabake {

/// The fingerprints of one bake's cells. Rank 0 plans with these fingerprints; each bake process checks them against
/// its own inputs with match().
/// Exact   A fingerprint depends on the set of tiles and their multiplicity, not on their order, because results do not
///         depend on the order of triangles. It depends on the area of interest only if the area's border cuts the
///         cell, and then only on the border in the cell. It depends on exactly those edits that select a voxel of the
///         cell, and on their order.
class CellFingerprints {
 public:
  /// `area` is the area of interest; null without one. `edits` are the edits of the scene; null without any.
  /// Errors  UsageError like AreaInScene() and EditsInScene().
  CellFingerprints(const BakeParameters& parameters, const std::optional<Geodetic>& origin,
                   std::shared_ptr<const Area> area = nullptr, std::shared_ptr<const EditList> edits = nullptr);
  /// Takes origin, area, edits, and the edits and levels of tiles from the sources.
  CellFingerprints(const BakeParameters& parameters, const SceneSources& sources);

  /// Returns the fingerprint of a cell. `tile_sources` has the TileScan::source of each of job.tiles, in any order
  /// if no tile has edits or a level.
  Hash128 of(const CellJob& job, std::vector<Hash128> tile_sources) const;
  /// A result of the same cell with only the first `edits` of the edits that select a voxel of it.
  struct EarlierEdits {
    std::size_t edits;
    Hash128 fingerprint;
  };
  /// Returns results with fewer edits, the most edits first: up to `max_earlier_edits`, then without edits.
  /// Range   The job has tile_sources, unless it has no tiles.
  std::vector<EarlierEdits> with_fewer_edits(const CellJob& job) const;
  static constexpr std::size_t max_earlier_edits = 64;
  /// Returns whether the job's fingerprint matches these parameters and this origin. Returns true for an overview job,
  /// because its fingerprint derives from the fingerprints of its children. Returns true for a job without
  /// tile_sources, because its result is not stored by fingerprint.
  bool match(const CellJob& job) const;

 private:
  /// Adds to the identity of each tile its level, if that is not 0.
  void add_levels(const CellJob& job, std::vector<Hash128>& tile_sources) const;
  /// Adds to the identity of each tile the edits that may change its surface in the cell.
  void add_source_edits(const CellJob& job, std::vector<Hash128>& tile_sources) const;
  Hash128 without_edits(const CellJob& job, std::vector<Hash128> tile_sources) const;
  std::vector<std::uint32_t> edits_of(const CellJob& job) const;

  std::vector<std::uint8_t> shared_;  ///< inputs that all cells share
  SnapFrame frame_;
  std::optional<AreaInScene> area_;
  std::optional<EditsInScene> edits_;
  std::vector<std::uint8_t> lod_of_tile_;  ///< empty if all tiles are voxelized at lod 0
  /// Edits of sources by TileRef::edits, and TileRef::edits by tile; both are empty if no tile has edits.
  std::map<const SourceEdits*, SourceEditsInScene> source_edits_;
  std::vector<const SourceEdits*> edits_of_tile_;
};

}  // namespace gigabake
