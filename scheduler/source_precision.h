/// Can the sources say where their vertices are as finely as the bake looks?
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/job/survey.h"
#include "format/source/source.h"

namespace gigabake {

/// A source that cannot, in the placement where it is coarsest.
struct CoarseSource {
  std::string name;
  double spacing_m = 0;  ///< TileSurvey::spacing_m
};

struct SourcePrecision {
  double wanted_m = 0;               ///< a quarter of a voxel
  double largest_spacing_m = 0;      ///< of all sources
  std::vector<CoarseSource> coarse;  ///< spacing above wanted_m: coarsest first, at most most_listed
  std::uint64_t coarse_sources = 0;  ///< all of them, each name once
  static constexpr std::size_t most_listed = 16;
};

/// Exact   A function of the set of surveys: their order does not show.
SourcePrecision source_precision(const std::vector<TileSurvey>& surveys, const SceneSources& sources,
                                 double voxel_size_m);

}  // namespace gigabake
