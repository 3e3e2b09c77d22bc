/// The name of a cell's result: a hash of all that it is baked from.
#pragma once

#include <optional>
#include <vector>

#include "format/job/cell_job.h"
#include "lattice/parameters.h"

namespace gigabake {

/// The fingerprints of one bake's cells. Rank 0 plans with them, and each bake process computes them again from what
/// it is about to use: match().
/// Exact  Depends on which tiles there are and how often, not on their order: no result depends on that of triangles.
class CellFingerprints {
 public:
  CellFingerprints(const BakeParameters& parameters, const std::optional<Geodetic>& origin);

  /// tile_sources: TileSurvey::source of job.tiles, in any order.
  Hash128 of(const CellJob& job, std::vector<Hash128> tile_sources) const;
  /// Returns whether the job's fingerprint is of these parameters and this origin. True of an overview job, whose
  /// fingerprint is made of its children's, and of a job without tile_sources, which nobody names results by.
  bool match(const CellJob& job) const;

 private:
  std::vector<std::uint8_t> shared_;  ///< what all cells have in common
};

}  // namespace gigabake
