/// Comparison of the sources' coordinate resolution with the voxel size.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/job/tile_scan.h"
#include "format/source/source.h"

namespace gigabake {

/// A source whose coordinate resolution is too coarse, at its coarsest placement.
struct CoarseSource {
  std::string name;
  double spacing_m = 0;  ///< TileScan::spacing_m
};

struct SourcePrecision {
  double wanted_m = 0;               ///< required coordinate resolution: a quarter of a voxel
  double max_spacing_m = 0;          ///< max coordinate resolution over all sources
  std::vector<CoarseSource> coarse;  ///< sources with a spacing above wanted_m: coarsest first, at most max_listed
  std::uint64_t coarse_sources = 0;  ///< number of all sources with a spacing above wanted_m; a name counts once
  static constexpr std::size_t max_listed = 16;
};

/// Compares the coordinate resolution of the scanned tiles with the voxel size.
/// Exact   The result does not depend on the order of `scans`.
SourcePrecision source_precision(const std::vector<TileScan>& scans, const SceneSources& sources, double voxel_size_m);

}  // namespace gigabake
