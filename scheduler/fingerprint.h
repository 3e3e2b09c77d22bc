/// The name of a cell's result: a hash of exactly what it is baked from.
#pragma once

#include <optional>
#include <vector>

#include "format/job/cell_job.h"
#include "lattice/parameters.h"

namespace gigabake {

/// The names of one bake's cells.
/// Exact  Depends on which tiles there are and how often, not on their order: no result depends on that of triangles.
class CellFingerprints {
 public:
  CellFingerprints(const BakeParameters& parameters, const std::optional<Geodetic>& origin);

  /// tile_sources: TileSurvey::source of job.tiles, in any order.
  Hash128 of(const CellJob& job, std::vector<Hash128> tile_sources) const;

 private:
  std::vector<std::uint8_t> shared_;  ///< what all cells have in common
};

}  // namespace gigabake
