/// Parallel views of blocks: rays, exact intersections, and the alpha of each candidate.
#pragma once

#include <string>
#include <vector>

#include "bench/levels/blocks.h"

namespace gigabake::bench {

struct SightRay {
  Vector3 origin, direction;  ///< direction: unit
};

/// Returns true if the ray crosses a finest voxel.
bool meets_voxel(const Blocks& blocks, const SightRay& ray, double length);

/// Function that returns a candidate's alpha along a ray.
using Candidate = double (*)(const Blocks& blocks, const SightRay& ray, double length);

struct NamedCandidate {
  std::string name;
  int bytes;  ///< per coarse voxel, in addition to colour and normal, before compression
  Candidate alpha;
};

/// Returns all candidates that are compared, in the order of the table.
const std::vector<NamedCandidate>& level_candidates();

}  // namespace gigabake::bench
